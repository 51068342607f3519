"""The page's door: a viser server that this machine's own browser may enter, and nobody else."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final
from urllib.parse import urlsplit

import rich
import viser

HOST: Final = "127.0.0.1"
OWN_NAMES: Final = (HOST, "localhost")

POLICY_VIOLATION: Final = 1008
"""What a WebSocket says when it closes on somebody who may not enter (RFC 6455, 7.4.1)."""


class PageError(RuntimeError):
    """The page cannot be opened: the text says why and what to do."""


def open_server(port: int) -> viser.ViserServer:
    """A server on exactly this port of the loopback interface.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """
    refuse_port(port)
    with _quiet():
        server = viser.ViserServer(host=HOST, port=port, label="tritrack", verbose=False)
    if server.get_port() != port:
        close_server(server)
        raise PageError(_unusable(port, "another program was faster"))
    _guard(server)
    return server


def close_server(server: viser.ViserServer) -> None:
    """Take the page down and free its port."""
    with _quiet():
        server.stop()


def is_own(host: str, origin: str) -> bool:
    """Whether a connection comes from this very page.

    Any web page may try to connect to this machine, and a foreign name may be made to point here;
    a browser tells both by these headers. A program that is no browser sends no origin.

    Args:
        host: The request's `Host`, as 127.0.0.1:8080; a forwarded port may differ from ours.
        origin: The request's `Origin`, or "".
    """
    named = urlsplit(f"//{host}").hostname
    return named in OWN_NAMES and (not origin or urlsplit(origin).netloc == host)


def _guard(server: viser.ViserServer) -> None:
    """Close on strangers before anything is sent; viser has no setting for it."""
    sockets = server._websock_server

    async def refuse_strangers(client: Any) -> None:
        connection = sockets._live_connections[client.client_id]
        headers = connection.request.headers
        if not is_own(headers.get("Host", ""), headers.get("Origin", "")):
            await connection.close(POLICY_VIOLATION, "only this machine's own page may connect")

    sockets.on_client_connect(refuse_strangers)


def refuse_port(port: int) -> None:
    """Viser would quietly take the next free port, and the address told to the user be wrong.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """
    if port == 0:
        raise PageError("page.port is 0, which means no page: set it to a free port, as 8080")
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, port))
        except OSError as error:
            raise PageError(_unusable(port, str(error.strerror).lower())) from error


def _unusable(port: int, why: str) -> str:
    return (
        f"cannot open the page on port {port}: {why}; "
        "close what uses it, or set page.port to another one (or --port)"
    )


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep viser's own announcements off the terminal: the commands say what matters."""
    console = rich.get_console()
    was, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = was
