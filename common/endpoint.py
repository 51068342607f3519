"""Who can reach an endpoint: this machine alone, or other machines too."""

import ipaddress
import re
from typing import Final

FORM: Final = re.compile(
    r"(?:(?:tcp|tls|udp|quic|ws)/(?P<host>[^/]*):\+?(?P<port>\d+)(?:[?#].*)?"
    r"|(?:unixsock-stream|unixpipe|vsock|serial)/.+)"
)
"""The form of an endpoint, with all protocols that Zenoh knows."""
ADDRESS: Final = re.compile(r"[^/]*/(?P<host>.*):\+?\d+(?:[?#].*)?", re.DOTALL)
"""Endpoints with a host and a port, as Zenoh reads them; all others are within this machine."""


def is_loopback(host: str) -> bool:
    """Whether a name or address belongs to this machine alone.

    Names are not looked up: of names only `localhost` counts as ours.
    """
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host == "localhost"


def is_host(text: str) -> bool:
    """Whether a text can be looked up as a name or address: each part has at most 63 letters."""
    try:
        text.encode("idna")
    except UnicodeError:
        return False
    return text.isprintable() and not set(text) & set("/@?# ")


def is_endpoint(text: str) -> bool:
    """Whether a text has the form of an endpoint, tcp/127.0.0.1:7447; names are not looked up."""
    form = FORM.fullmatch(text)
    if form is None:
        return False
    return form["port"] is None or (is_host(form["host"]) and _is_port(form["port"]))


def is_exposed(endpoint: str) -> bool:
    """Whether other machines may reach an endpoint, as tcp/192.168.1.5:7447."""
    where = ADDRESS.fullmatch(endpoint)
    return where is not None and not is_loopback(where["host"])


def address_of(text: str) -> tuple[str, int]:
    """Host and port of an address such as `127.0.0.1:9464`.

    Raises:
        ValueError: When it is no such address.
    """
    host, _, port = text.rpartition(":")
    if not (host and is_host(host) and _is_port(port)):
        raise ValueError(f"metrics must look like 127.0.0.1:9464, got {text!r}")
    return host, int(port)


def _is_port(text: str) -> bool:
    return text.isdecimal() and 0 < int(text) < 65536
