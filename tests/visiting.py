"""Somebody who opens the page of a live run: it begins then, and waits no longer for them."""

import json
import re
from typing import IO, Final

from websockets.sync.client import connect

PAGE: Final = re.compile(r"the page: (http://127\.0\.0\.1:\d+)")
PATIENCE_S: Final = 300.0


def visited(said: IO[str]) -> str:
    """What a run prints until the address of its page, which is looked at until the run is over."""
    before = ""
    for line in said:
        before += line
        found = PAGE.search(line)
        if found is not None:
            look_on(found[1])
            break
    return before


def look_on(address: str) -> None:
    """Hear all that a browser is told, to the end."""
    with connect(address.replace("http", "ws") + "/live", max_size=None) as browser:
        while json.loads(browser.recv(timeout=PATIENCE_S))["kind"] != "over":
            pass
