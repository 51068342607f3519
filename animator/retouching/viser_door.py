"""Access to the retouching page: a viser server for this machine's own browser alone."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import rich
import viser

from animator.page.door import HOST, PageError, is_own, refuse_port, unusable

POLICY_VIOLATION: Final = 1008
"""Close code of a WebSocket for a client that may not enter (RFC 6455, 7.4.1)."""


def open_server(port: int) -> viser.ViserServer:
    """A server on exactly this port of the loopback interface.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """
    refuse_port(port)
    logging.getLogger("websockets.server").setLevel(logging.WARNING)  # it logs every browser
    with _quiet():
        server = viser.ViserServer(host=HOST, port=port, label="tritrack", verbose=False)
    if server.get_port() != port:
        close_server(server)
        raise PageError(unusable(port, "another program was faster"))
    _guard(server)
    return server


def close_server(server: viser.ViserServer) -> None:
    """Take the page down and free its port."""
    with _quiet():
        server.stop()


def _guard(server: viser.ViserServer) -> None:
    """Close foreign connections before anything is sent; viser has no setting for it."""
    sockets = server._websock_server

    async def refuse_strangers(client: viser.ClientHandle) -> None:
        connection = sockets._live_connections[client.client_id]
        headers = connection.request.headers
        if not is_own(headers.get("Host", ""), headers.get("Origin", "")):
            await connection.close(POLICY_VIOLATION, "only this machine's own page may connect")

    sockets.on_client_connect(refuse_strangers)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep viser's own announcements off the terminal: the commands print what matters."""
    logging.getLogger("websockets").setLevel(logging.WARNING)
    console = rich.get_console()
    was, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = was
