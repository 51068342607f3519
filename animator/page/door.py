"""The pages' door: which port is free, and who may come in: this machine's own browser alone."""

import socket
from typing import Final
from urllib.parse import urlsplit

HOST: Final = "127.0.0.1"
OWN_NAMES: Final = (HOST, "localhost")


class PageError(RuntimeError):
    """The page cannot be opened: the text says why and what to do."""


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


def refuse_port(port: int) -> None:
    """A server that quietly took the next free port would make the address told to the user wrong.

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
            raise PageError(unusable(port, str(error.strerror).lower())) from error


def unusable(port: int, why: str) -> str:
    """What to say of a port that cannot be had."""
    return (
        f"cannot open the page on port {port}: {why}; "
        "close what uses it, or set page.port to another one (or --port)"
    )
