"""Access to the pages: address and port of a page, and who may enter."""

import secrets
import socket
from collections.abc import Sequence
from typing import Final, NamedTuple
from urllib.parse import parse_qs, urlsplit

from common.config.part_settings import PageSettings
from common.endpoint import is_loopback

HOST: Final = "127.0.0.1"
EVERY_ADDRESS: Final = ("0.0.0.0", "::")
BY_SETTINGS: Final = "set page.port to another one"
"""How a live run takes another port."""
BY_OPTION: Final = f"{BY_SETTINGS} (or --port)"
"""The cure where the command has the option too."""


class PageError(RuntimeError):
    """The page cannot be opened: the text says why and what to do."""


class Entrance(NamedTuple):
    """Where a page listens, and who may enter."""

    host: str = HOST
    name: str = ""
    """Host name of a proxy before it, beside this machine's own names."""
    token: str = ""
    """The token that a browser must send; "": none, where no other machine can connect."""


def entrance_of(settings: PageSettings) -> Entrance:
    """The entrance by the settings, with a new token where other machines can connect."""
    token = "" if is_loopback(settings.host) else secrets.token_urlsafe()
    return Entrance(settings.host, settings.name, token)


def address_of(entrance: Entrance, port: int) -> str:
    """Host names by which browsers address the page."""
    host = socket.gethostname() if entrance.host in EVERY_ADDRESS else entrance.host
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def invitation_of(entrance: Entrance, port: int) -> str:
    """The page's address with its token: for the user who started it alone."""
    token = f"/?token={entrance.token}" if entrance.token else ""
    return f"{address_of(entrance, port)}{token}"


def is_own(host: str, origin: str, entrance: Entrance = Entrance()) -> bool:
    """Whether a connection comes from this very page.

    Any web page may try to connect to this machine, and a foreign name may resolve to it; these
    headers of a browser reveal both. A program other than a browser sends no origin. Where a token
    is required, the page may have any name: no foreign one has the cookie.

    Args:
        host: The request's `Host`, as 127.0.0.1:8080; a forwarded port may differ from ours.
        origin: The request's `Origin`, or "".
        entrance: The page's entrance.
    """
    try:
        named, whence = urlsplit(f"//{host}").hostname, urlsplit(origin).netloc
    except ValueError:
        return False
    if not named or not (is_loopback(named) or named == entrance.name or entrance.token):
        return False
    return not origin or whence == host


def cookie_of(port: int) -> str:
    """Name of the cookie with the token: cookies do not distinguish ports."""
    return f"tritrack_{port}"


def has_token(entrance: Entrance, query: str, cookies: Sequence[str], port: int) -> bool:
    """Whether a request contains the token, in its address or as a cookie.

    Args:
        entrance: The page's entrance.
        query: The part of the address after the `?`.
        cookies: The request's `Cookie` headers.
        port: The page's port.
    """
    pairs = [each.strip().partition("=") for line in cookies for each in line.split(";")]
    brought = [value for name, _, value in pairs if name == cookie_of(port)]
    brought += parse_qs(query).get("token", [])
    due = entrance.token.encode()
    return not due or any(
        secrets.compare_digest(each.encode(errors="replace"), due) for each in brought
    )


def refuse_port(port: int, host: str = HOST, cure: str = BY_OPTION) -> None:
    """Raise where a port is not free: a server on the next free port would make the printed address
    wrong.

    Args:
        port: The page's port.
        host: The address that it listens on.
        cure: How the present command takes another port.

    Raises:
        PageError: When the port is 0, taken or not allowed, or the host is not this machine's.
    """
    if port == 0:
        raise PageError("page.port is 0, which means no page: set it to a free port, as 8080")
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        with socket.socket(found[0][0]) as trial:
            trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind(found[0][4])
    except OSError as error:
        raise PageError(unusable(port, str(error.strerror).lower(), host, cure)) from error


def unusable(port: int, why: str, host: str = HOST, cure: str = BY_OPTION) -> str:
    """The message for an unavailable port."""
    where = "" if host == HOST else f" of {host}"
    return f"cannot open the page on port {port}{where}: {why}; close what uses it, or {cure}"
