"""A file that leads this user's browser to the start page with its token."""

import html
import os
from pathlib import Path
from typing import Final

LETTER: Final = "open.html"
LETTER_TEXT: Final = """<!doctype html>
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}">
<title>tritrack</title>
<p><a href="{address}">The start page</a></p>
"""


def letter_of(folder: Path, address: str) -> Path:
    """A file for this user's eyes alone that leads a browser to an address.

    Every user of the machine reads the arguments of a browser, where the address with its token
    would stand.

    Args:
        folder: Where it lies until the page ends: a browser in a sandbox may read no folder but the
            user's own.
        address: Of the page, with its token.
    """
    path = folder / LETTER
    text = LETTER_TEXT.format(address=html.escape(address))
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(text)
    return path
