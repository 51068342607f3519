"""The start page, until Ctrl-C: from videos or cameras to a result without another command."""

import html
import os
import secrets
import sys
import webbrowser
from contextlib import suppress
from pathlib import Path
from typing import Final

from rich.console import Console

from animator.page.door import Entrance, invitation_of, refuse_port
from animator.start.start_page import StartPage
from common.bus.process import ProcessContext, process
from tritrack.starting.start_desk import Given, StartDesk
from tritrack.starting.uploads import FOLDER

LOOK_S: Final = 0.01
"""Interval at which browsers' messages are read, seconds."""
LETTER: Final = "open.html"
LETTER_TEXT: Final = """<!doctype html>
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}">
<title>tritrack</title>
<p><a href="{address}">The start page</a></p>
"""
SCREENS: Final = ("DISPLAY", "WAYLAND_DISPLAY")
"""Environment variables of a session with a screen."""


def start(given: Given, port: int, browser: bool, console: Console) -> None:
    """Serve the start page until Ctrl-C; its jobs end with it.

    Args:
        given: What the page is about.
        port: The page's port.
        browser: Open the user's browser, where there is a screen.
        console: Shows the page's address.

    Raises:
        PageError: When the port is taken or not allowed.
        UploadRefused: When the folder of the runs cannot be written.
    """
    refuse_port(port, cure="name another --port")
    entrance = Entrance(token=secrets.token_urlsafe())  # other users of this machine reach it too
    with process("start", ProcessContext()) as stop:
        desk = StartDesk(given)
        try:
            page = StartPage(desk.hello, desk.file, port, entrance)
            address = invitation_of(entrance, port)
            console.print(
                f"the page is at {address}; Ctrl-C ends it", highlight=False, soft_wrap=True
            )
            if browser and has_screen():
                with suppress(webbrowser.Error):
                    webbrowser.open(letter_of(given.runs / FOLDER, address).absolute().as_uri())
            try:
                while not stop.wait(LOOK_S):
                    desk.turn(page)
            finally:
                page.close()
        finally:
            desk.close()


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


def has_screen() -> bool:
    """Whether a browser with a window can be opened: on Linux only in a session with a screen."""
    return not sys.platform.startswith("linux") or any(os.environ.get(name) for name in SCREENS)
