"""A page for one user's wishes: the newest of each section for browsers, and what they ask."""

import json
import queue
import threading
from collections.abc import Callable
from typing import Any, Final, Generic, TypeVar

import msgspec

from animator.page.door import Entrance
from animator.page.page_server import File, PageServer

Wish = TypeVar("Wish")


class Told(msgspec.Struct, frozen=True, tag="told", tag_field="kind"):
    """The outcome of a wish."""

    text: str
    well: bool


BUSY: Final = Told("too much is asked at once, and this was not taken: try it again", well=False)
"""The answer to a browser whose wish found no room."""


def encoded(message: Any) -> bytes:
    """A message for browsers; a file's name that is no Unicode is sent with its bytes escaped."""
    try:
        return msgspec.json.encode(message)
    except UnicodeEncodeError:
        return json.dumps(msgspec.to_builtins(message)).encode()


class WishPage(Generic[Wish]):
    """A page for browsers at `address`, until `close`.

    Args:
        hello: First message to every browser.
        heard: Reads a browser's message; raises where it is none of the page's.
        port: A free port of this machine.
        entrance: Where the page listens, and who may enter.
        file_of: Gives the page's files, None where there is none; called in the server's thread.
        most_said_bytes: Upper bound of a browser's message.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """

    def __init__(
        self,
        hello: msgspec.Struct,
        heard: Callable[[bytes], Wish],
        port: int,
        entrance: Entrance,
        file_of: Callable[[str], File | None],
        most_said_bytes: int,
    ) -> None:
        self._heard, self._lock = heard, threading.Lock()
        self._newest: dict[type, bytes] = {type(hello): encoded(hello)}
        self._server = PageServer(
            port, self._greeting, entrance, file_of, most_said_bytes, encoded(BUSY)
        )
        self.address = self._server.address
        """Address of the page, without its token."""

    def show(self, section: msgspec.Struct) -> None:
        """Send every browser, now and later, a section, where it has changed."""
        said = encoded(section)
        with self._lock:
            if self._newest.get(type(section)) == said:
                return
            self._newest[type(section)] = said
        self._server.tell(said)

    def tell(self, message: msgspec.Struct) -> None:
        """Send the browsers of now a message."""
        self._server.tell(encoded(message))

    def next_wish(self) -> Wish | None:
        """The browsers' messages, oldest first; None when there is none.

        Raises:
            ValueError: When it is no message of our page, as `heard` says it.
        """
        try:
            return self._heard(self._server.asked.get_nowait())
        except queue.Empty:
            return None

    def close(self) -> None:
        """Take the page down and free the port."""
        self._server.close()

    def _greeting(self) -> list[bytes]:
        with self._lock:
            return [*self._newest.values()]
