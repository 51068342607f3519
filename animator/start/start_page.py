"""The start page's server: the newest of each section for browsers, and their wishes."""

import queue
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Final

from animator.page.door import Entrance
from animator.page.page_server import SITE, File, PageServer, site
from animator.start.sections import Got, Hello, Section, Told, encoded
from animator.start.wishes import MOST_SAID_BYTES, AnyWish, Chunk, heard

OWN_SITE: Final = Path(__file__).parent / "site"

FileOf = Callable[[str], File | None]
"""A file of the runs by its path in requests, None where there is none; called in the server's
thread."""


class StartPage:
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
        self._file_of, self._lock = file_of, threading.Lock()
        self._newest: dict[type[Section], bytes] = {Hello: encoded(hello)}
        self._server = PageServer(port, self._greeting, entrance, self._file, MOST_SAID_BYTES)
        self.address = self._server.address
        """Address of the page, without its token."""

    @property
    def watched(self) -> bool:
        """Whether any browser is connected."""
        return self._server.watched

    def show(self, section: Section) -> None:
        """Send every browser, now and later, a section, where it has changed."""
        said = encoded(section)
        with self._lock:
            if self._newest.get(type(section)) == said:
                return
            self._newest[type(section)] = said
        self._server.tell(said)

    def tell(self, message: Told | Got) -> None:
        """Send the browsers of now a message."""
        self._server.tell(encoded(message))

    def next_wish(self) -> AnyWish | Chunk | None:
        """The browsers' messages, oldest first; None when there is none.

        Raises:
            WishError: When it is no message of our page.
        """
        try:
            return heard(self._server.asked.get_nowait())
        except queue.Empty:
            return None

    def close(self) -> None:
        """Take the page down and free the port."""
        self._server.close()

    def _greeting(self) -> list[bytes]:
        with self._lock:
            return [*self._newest.values()]

    def _file(self, path: str) -> File | None:
        return site(SITE, OWN_SITE).get(path) or self._file_of(path)
