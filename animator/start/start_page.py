"""The start page's server: its sections for browsers, their wishes, and the files of runs."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from animator.page.door import Entrance
from animator.page.page_server import SITE, File, site
from animator.page.wish_page import WishPage
from animator.start.sections import Hello
from animator.start.wishes import MOST_SAID_BYTES, AnyWish, Chunk, heard

OWN_SITE: Final = Path(__file__).parent / "site"

FileOf = Callable[[str], File | None]
"""A file of the runs by its path in requests, None where there is none; called in the server's
thread."""


class StartPage(WishPage[AnyWish | Chunk]):
    """A page for browsers at `address`, until `close`.

    Args:
        hello: First message to every browser.
        file_of: Gives pictures and downloads.
        port: A free port of this machine.
        entrance: Where the page listens, and who may enter.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """

    def __init__(self, hello: Hello, file_of: FileOf, port: int, entrance: Entrance) -> None:
        def file(path: str) -> File | None:
            return site(SITE, OWN_SITE).get(path) or file_of(path)

        super().__init__(hello, heard, port, entrance, file, MOST_SAID_BYTES)
