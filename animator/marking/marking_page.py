"""The marking page's server: pictures, the newest sheet for browsers, and their messages."""

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import msgspec

from animator.marking.sheet import MOST_SAID_BYTES, Hello, Marked, Save, heard
from animator.page.door import Entrance
from animator.page.page_server import SITE, File, site
from animator.page.wish_page import WishPage

OWN_SITE: Final = Path(__file__).parent / "site"
STILL: Final = re.compile(r"/still/([12])/(\d{1,6}|live)\.jpg", re.ASCII)
LIVE: Final = -1
"""Index that stands for the camera's newest picture."""

JpegOf = Callable[[int, int], bytes | None]
"""A still by its camera (1 or 2) and index (from 0, or LIVE), None where there is none."""


def still_address(camera: int, place: int) -> str:
    """Address of a still."""
    return f"/still/{camera}/{'live' if place == LIVE else place}.jpg"


class MarkingPage(WishPage[Marked | Save]):
    """A page for browsers at `address`, until `close`.

    Args:
        hello: First message to every browser; its run is filled in.
        jpeg_of: Gives the pictures; called in the server's thread.
        port: A free port of this machine.
        entrance: Where the page listens, and who may enter.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """

    def __init__(
        self, hello: Hello, jpeg_of: JpegOf, port: int, entrance: Entrance = Entrance()
    ) -> None:
        hello = msgspec.structs.replace(hello, run=time.time_ns() // 1_000_000)
        self._jpeg_of = jpeg_of
        super().__init__(hello, heard, port, entrance, self._file, MOST_SAID_BYTES)

    def _file(self, path: str) -> File | None:
        asked = STILL.fullmatch(path)
        if asked is None:
            return site(SITE, OWN_SITE).get(path)
        place = LIVE if asked[2] == "live" else int(asked[2])
        jpeg = self._jpeg_of(int(asked[1]), place)
        return None if jpeg is None else File("image/jpeg", jpeg)
