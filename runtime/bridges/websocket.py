"""Bodies and postures by WebSocket, as JSON or MessagePack, with a plain page that draws them.

Each message is an object of one key, `body` or `posture`, whose value is the message of that kind
as `docs/messages.schema.json` describes it.
"""

import logging
import socket
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

import msgspec
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from animator.page.door import (
    Entrance,
    PageError,
    entrance_of,
    has_token,
    invitation_of,
    is_own,
    refuse_port,
    unusable,
)
from animator.page.page_server import MOST_SAID_BYTES, headers_of, is_of_ours, kept_token, site
from common.bus.mailbox import Mailbox
from common.bus.messages import Body, Posture
from common.config.part_settings import PageSettings
from common.endpoint import is_loopback
from runtime.bridges.osc import host_and_port

SITE: Final = Path(__file__).parent / "site"
SOCKET: Final = "/bodies"
"""Path of the WebSocket."""
JSON: Final = Subprotocol("tritrack.json")
"""The subprotocol of text messages, which programs that name none get too."""
MSGPACK: Final = Subprotocol("tritrack.msgpack")
"""The subprotocol of binary messages."""
WAITING: Final = 256
"""Messages that may wait for a program; a slower one loses the oldest."""
MOST_PROGRAMS: Final = 50
LOOK_S: Final = 0.2
"""Interval, seconds, at which a silent connection is checked for its end."""
ENDS_S: Final = 2.0
"""Seconds that programs have for what still waits as the bridge ends."""
CURE: Final = "take another port by --to"

Packet = tuple[bytes, bytes]
"""A message in JSON and in MessagePack."""


class WebSocket:
    """A server for programs and pages, until `close`.

    Args:
        to: `HOST:PORT` to listen at. Where other machines can connect, a token is asked for.

    Raises:
        BridgeError: When `to` is no address.
        PageError: When nothing can listen there.
    """

    is_of_one = False

    def __init__(self, to: str) -> None:
        """Listen."""
        host, port = host_and_port(to)
        refuse_port(port, host, CURE)
        self._entrance, self._port = entrance_of(PageSettings(host=host)), port
        self.address = invitation_of(self._entrance, port)
        self._waiting: dict[Mailbox[Packet], ServerConnection] = {}
        self._lock = threading.Lock()
        log = logging.getLogger(f"{__name__}.socket")
        log.addFilter(is_of_ours)
        log.setLevel(logging.WARNING)
        try:
            self._server = serve(
                self._attend,
                host,
                port,
                subprotocols=[JSON, MSGPACK],
                select_subprotocol=_chosen,
                process_request=self._request,
                max_size=MOST_SAID_BYTES,
                compression=None,
                server_header=None,
                logger=log,
            )
        except OSError as error:
            why = str(error.strerror).lower()
            raise PageError(unusable(port, why, host, CURE)) from error
        threading.Thread(target=self._server.serve_forever, name="websocket", daemon=True).start()

    def send_body(self, body: Body) -> bool:
        """Hand it to every program; never waits for one."""
        self._spread({"body": body})
        return True

    def send_posture(self, posture: Posture) -> None:
        """Hand it to every program; never waits for one."""
        self._spread({"posture": posture})

    def close(self) -> None:
        """Send what waits, disconnect the programs, and free the port.

        A program that takes nothing more is cut off after a moment: its thread would wait for ever.
        """
        with self._lock:
            for mailbox in self._waiting:
                mailbox.close()
        self._server.shutdown()
        until_s = time.monotonic() + ENDS_S
        while self._waiting and time.monotonic() < until_s:
            time.sleep(0.01)
        with self._lock:
            for connection in self._waiting.values():
                with suppress(OSError):
                    connection.socket.shutdown(socket.SHUT_RDWR)

    def _spread(self, message: dict[str, Body] | dict[str, Posture]) -> None:
        packet = msgspec.json.encode(message), msgspec.msgpack.encode(message)
        with self._lock:
            for mailbox in self._waiting:
                mailbox.put(packet)

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """A file of the page; None where a WebSocket may be opened."""
        path, _, query = request.path.partition("?")
        if not may_enter(request, self._entrance, query, self._port):
            text = "pages of this machine, and programs with the token where one is asked for\n"
            return connection.respond(HTTPStatus.FORBIDDEN, text)
        if path == SOCKET:
            full = len(self._waiting) >= MOST_PROGRAMS
            text = f"{MOST_PROGRAMS} programs listen already: close one of them\n"
            return connection.respond(HTTPStatus.SERVICE_UNAVAILABLE, text) if full else None
        if path == "/" and self._entrance.token and "token=" in query:
            kept = kept_token(self._entrance, self._port)
            return Response(HTTPStatus.SEE_OTHER, "See Other", kept)
        found = site(SITE).get(path)
        if found is None:
            return connection.respond(HTTPStatus.NOT_FOUND, f"the WebSocket is at {SOCKET}\n")
        return Response(HTTPStatus.OK, "OK", headers_of(*found), found[1])

    def _attend(self, connection: ServerConnection) -> None:
        """Serve one program until it disconnects or the bridge ends."""
        mailbox: Mailbox[Packet] = Mailbox(WAITING)
        is_binary = connection.subprotocol == MSGPACK
        with self._lock:
            self._waiting[mailbox] = connection
        try:
            with suppress(ConnectionClosed):
                while not mailbox.over and connection.close_code is None:
                    if (packet := mailbox.take(LOOK_S)) is not None:
                        connection.send(packet[is_binary], text=not is_binary)
        finally:
            with self._lock:
                del self._waiting[mailbox]


def may_enter(request: Request, entrance: Entrance, query: str, port: int) -> bool:
    """Whether a program without a browser asks, or a page of this machine, of any of its ports;
    with the token where one is due."""
    host, origin = request.headers.get("Host", ""), request.headers.get("Origin", "")
    try:
        is_local = not origin or is_loopback(urlsplit(origin).hostname or "")
    except ValueError:
        return False
    if not is_own(host, "", entrance) or not (is_local or entrance.token):
        return False
    return has_token(entrance, query, request.headers.get_all("Cookie"), port)


def _chosen(_: ServerConnection, offered: Sequence[Subprotocol]) -> Subprotocol | None:
    """JSON where a program names no subprotocol, or one that there is not."""
    return next((each for each in offered if each in (JSON, MSGPACK)), None)
