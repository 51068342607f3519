"""The live page's server: its files, and a WebSocket to each admitted browser."""

import asyncio
import logging
import mimetypes
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Final, NamedTuple

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.http11 import Request, Response

from animator.page.door import (
    Entrance,
    PageError,
    address_of,
    cookie_of,
    has_token,
    is_own,
    refuse_port,
    unusable,
)
from common.npz_file import Facts

SITE: Final = Path(__file__).parent / "site"
SOCKET: Final = "/live"
"""Path of the WebSocket."""
WAITING: Final = 256
"""Messages that may wait for a browser; a slower one loses the oldest."""
MOST_SAID_BYTES: Final = 1000
"""Upper bound of a browser's message, bytes, unless a page accepts more."""
MOST_ASKED: Final = 16
"""Largest number of requests that wait to be answered."""
PATIENCE_S: Final = 2.0
"""Seconds without room among those after which requests are refused."""
ROOM_S: Final = 0.02
"""Interval at which it looks for room, seconds."""
OPENS_S: Final = 20.0
"""Seconds within which a server must listen, or it never will, as where a name cannot be
resolved."""
MOST_BROWSERS: Final = 50
POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""Header with which the browser keeps the page from contacting another server."""

log = logging.getLogger(__name__)

REPORT_POLICY: Final = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src 'self' data:; media-src 'self' data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""The same for a page that a command wrote into a file: it has styles of its own, no script."""


class File(NamedTuple):
    """A file for browsers."""

    kind: str
    """MIME type."""
    content: bytes
    policy: str = POLICY


def is_of_ours(record: logging.LogRecord) -> bool:
    """Whether the library's log holds more than connections without a valid request: any user
    may open one, so the launcher itself checks that the page answers."""
    kind = record.exc_info[0] if record.exc_info else None
    return kind is None or not issubclass(kind, InvalidHandshake | EOFError | OSError)


class _Door(NamedTuple):
    """The server's thread, once it listens."""

    loop: asyncio.AbstractEventLoop
    server: Server
    over: asyncio.Event


def live_file(path: str) -> File | None:
    """The live page's file for a path, None where there is none."""
    return site(SITE).get(path)


class PageServer:
    """Serves the page on exactly this port, in a thread of its own.

    Args:
        port: A free port of this machine.
        greeting: Messages to a new browser, oldest first; called in the server's thread.
        entrance: Where it listens, the loopback interface by default, and who may enter.
        file_of: The page's file for a path, None where there is none; called in the server's
            thread.
        most_said_bytes: A browser that sends more at once is disconnected.
        busy: The answer to a browser whose request found no room.

    Raises:
        PageError: When the port is 0, taken or not allowed, the host's name is invalid, or the
            server does not listen within OPENS_S.
    """

    def __init__(
        self,
        port: int,
        greeting: Callable[[], list[bytes]],
        entrance: Entrance = Entrance(),
        file_of: Callable[[str], File | None] = live_file,
        most_said_bytes: int = MOST_SAID_BYTES,
        busy: bytes = b"",
    ) -> None:
        refuse_port(port, entrance.host)
        self.address = address_of(entrance, port)
        self.asked: queue.Queue[bytes] = queue.Queue(MOST_ASKED)
        """Messages from browsers."""
        self.came = 0
        """Number of browsers so far."""
        self._greeting = greeting
        self._entrance, self._port = entrance, port
        self._file_of, self._most_said_bytes, self._busy = file_of, most_said_bytes, busy
        self._full_s = 0.0
        """Since when there has been no room for a request; 0: there is."""
        self._browsers: dict[ServerConnection, asyncio.Queue[bytes]] = {}
        opened: Future[_Door] = Future()
        self._log = logging.getLogger(f"{__name__}.socket")
        self._log.addFilter(is_of_ours)
        self._log.setLevel(logging.WARNING)  # it would log every file that it serves
        self._thread = threading.Thread(target=lambda: self._run(opened), name="page", daemon=True)
        self._thread.start()
        try:
            self._door = opened.result(OPENS_S)
        except (OSError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or str(error) or "it does not answer"
            raise PageError(unusable(port, reason.lower(), entrance.host)) from error

    @property
    def watched(self) -> bool:
        """Whether any browser is connected."""
        return bool(self._browsers)

    def tell(self, message: bytes) -> None:
        """Send a message (JSON text) to every browser; never waits for one."""
        with suppress(RuntimeError):  # the loop is closed: there is no page
            self._door.loop.call_soon_threadsafe(self._spread, message)

    def close(self) -> None:
        """Take the page down and free its port."""
        with suppress(RuntimeError):
            self._door.loop.call_soon_threadsafe(self._door.over.set)
        self._thread.join()

    def _run(self, opened: "Future[_Door]") -> None:
        """The server's thread; exceptions while opening go to the caller."""
        try:
            asyncio.run(self._serve(opened))
        except Exception as error:
            if opened.done():
                raise
            opened.set_exception(error)

    async def _serve(self, opened: "Future[_Door]") -> None:
        over = asyncio.Event()
        server = await serve(
            self._attend,
            self._entrance.host,
            self._port,
            process_request=self._request,
            max_size=self._most_said_bytes,
            compression=None,
            server_header=None,
            logger=self._log,
        )
        opened.set_result(_Door(asyncio.get_running_loop(), server, over))
        async with server:
            await over.wait()

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """A file of the page; None where a WebSocket may be opened."""
        host, origin = request.headers.get("Host", ""), request.headers.get("Origin", "")
        path, _, query = request.path.partition("?")
        if not is_own(host, origin, self._entrance):
            text = "only this machine's own page may connect\n"
            return connection.respond(HTTPStatus.FORBIDDEN, text)
        if not has_token(self._entrance, query, request.headers.get_all("Cookie"), self._port):
            text = "open the page by its whole address, as it was printed: it ends in ?token=...\n"
            return connection.respond(HTTPStatus.FORBIDDEN, text)
        if path == SOCKET:
            full = len(self._browsers) >= MOST_BROWSERS
            text = f"{MOST_BROWSERS} browsers look at this page already: close one of them\n"
            return connection.respond(HTTPStatus.SERVICE_UNAVAILABLE, text) if full else None
        if path == "/" and self._entrance.token and "token=" in query:
            return Response(
                HTTPStatus.SEE_OTHER, "See Other", kept_token(self._entrance, self._port)
            )
        found = self._file_of(path)
        if found is None:
            return connection.respond(HTTPStatus.NOT_FOUND, "no such page\n")
        return Response(HTTPStatus.OK, "OK", headers_of(*found), found.content)

    async def _attend(self, connection: ServerConnection) -> None:
        """Serve one browser until it disconnects."""
        waiting: asyncio.Queue[bytes] = asyncio.Queue(WAITING)
        greeting = self._greeting()
        self._browsers[connection] = waiting
        self.came += 1
        speaking = asyncio.create_task(_speak(connection, greeting, waiting))
        try:
            async for said in connection:
                asked = said if isinstance(said, bytes) else said.encode()
                if not await self._has_taken(asked) and self._busy:
                    _give(waiting, self._busy)
        except ConnectionClosed:
            pass
        finally:
            del self._browsers[connection]
            speaking.cancel()

    async def _has_taken(self, asked: bytes) -> bool:
        """Keep a request for the program; its browser's next one waits meanwhile."""
        while True:
            try:
                self.asked.put_nowait(asked)
            except queue.Full:
                now_s = time.monotonic()
                self._full_s = self._full_s or now_s
                if now_s - self._full_s > PATIENCE_S:
                    return False
                await asyncio.sleep(ROOM_S)
            else:
                self._full_s = 0.0
                return True

    def _spread(self, message: bytes) -> None:
        for waiting in self._browsers.values():
            _give(waiting, message)


def _give(waiting: "asyncio.Queue[bytes]", message: bytes) -> None:
    """Let a message wait for a browser; a full queue loses the oldest."""
    if waiting.full():
        waiting.get_nowait()
    waiting.put_nowait(message)


async def _speak(
    connection: ServerConnection, greeting: list[bytes], waiting: asyncio.Queue[bytes]
) -> None:
    """Send the waiting messages, in order."""
    with suppress(ConnectionClosed):
        for message in greeting:
            await connection.send(message, text=True)
        while True:
            await connection.send(await waiting.get(), text=True)


@cache
def site(*folders: Path) -> dict[str, File]:
    """A page's files by their paths in requests; later folders take precedence."""
    files = {}
    for path in [path for folder in folders for path in sorted(folder.iterdir())]:
        kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
        files[f"/{path.name}"] = File(kind, path.read_bytes())
    return {**files, "/": files["/index.html"]}


def kept_token(entrance: Entrance, port: int) -> Headers:
    """Headers that move the token from the address bar, where it could be read and shared, to a
    cookie that no script reads and no foreign page makes a browser send."""
    cookie = f"{cookie_of(port)}={entrance.token}; HttpOnly; SameSite=Lax; Path=/"
    headers = headers_of("text/plain", b"")
    headers.update({"Location": "/", "Set-Cookie": cookie})
    return headers


def headers_of(kind: str, content: bytes, policy: str = POLICY) -> Headers:
    """The headers of an answer of this type and content, which no other site may use."""
    said: Facts = {
        "Content-Type": f"{kind}; charset=utf-8" if kind.startswith("text/") else kind,
        "Content-Length": str(len(content)),
        "Content-Security-Policy": policy,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Resource-Policy": "same-origin",
        "Cache-Control": "no-store",
        "Connection": "close",
    }
    return Headers(said)
