"""The ports of a run: refused before anything starts where they are taken, or found free."""

import importlib.util
import re
import secrets
import socket
from contextlib import suppress
from pathlib import Path
from typing import Final

import msgspec

from common.bus.bus_keys import PARTS_OF_EVERY_RUN, VIEWERS, refuse_missing
from common.config.part_settings import AUTO, PageSettings
from common.config.settings import Settings
from common.endpoint import address_of
from common.video.clip_sources import sources_of

TCP: Final = re.compile(r"(?:tcp|tls)/(?P<host>[^/]+):(?P<port>\d+)")
SESSION_BYTES: Final = 8
PORTS: Final = range(20_000, 32_768)
"""Ports that a run may choose. A system gives outgoing connections ports above these (Linux from
32,768, others from 49,152), also in the seconds before the run opens its own."""
MOST_TRIES: Final = 100


class PortHeld(ValueError):
    """A port that another program uses; the text names it and the cure."""


def refuse_held_ports(settings: Settings) -> None:
    """Check that bus, page and metrics can be opened, before anything starts.

    Raises:
        PortHeld: When the endpoint of the bus or the address of the metrics is taken, or the page
            or the metrics lack a library.
        PageError: When the page's port is taken.
        KeysError: When a part of a live run lacks its keys.
        ClipError: As `sources_of`.
    """
    if settings.bus.keys:
        viewers = (VIEWERS[one.number] for one in sources_of(settings))
        for part in (*PARTS_OF_EVERY_RUN, *viewers):
            refuse_missing(Path(settings.bus.keys), part)
    refuse_held_endpoint(settings)
    refuse_held_page(settings)
    refuse_held_metrics(settings.metrics)


def own_session(settings: Settings) -> Settings:
    """The same settings with a word for this run alone, where they have none."""
    if settings.bus.session:
        return settings
    bus = msgspec.structs.replace(settings.bus, session=secrets.token_hex(SESSION_BYTES))
    return msgspec.structs.replace(settings, bus=bus)


def free_settings(settings: Settings) -> Settings:
    """The same settings with free ports for endpoint and page."""
    bus = free_port()
    page = next(port for port in iter(free_port, None) if port != bus)
    kind = "tls" if settings.bus.keys else "tcp"
    return msgspec.structs.replace(
        settings,
        bus=msgspec.structs.replace(settings.bus, endpoint=f"{kind}/127.0.0.1:{bus}"),
        page=PageSettings(port=page) if settings.page.port else settings.page,
    )


def with_free_endpoint(settings: Settings) -> Settings:
    """The same settings with a free port of this machine where they leave it open."""
    if settings.bus.endpoint != AUTO:
        return settings
    endpoint = f"{'tls' if settings.bus.keys else 'tcp'}/127.0.0.1:{free_port()}"
    bus = msgspec.structs.replace(settings.bus, endpoint=endpoint)
    return msgspec.structs.replace(settings, bus=bus)


def ports(settings: Settings) -> list[int]:
    """The ports of a run; those that it may choose are left out."""
    bus = TCP.fullmatch(settings.bus.endpoint)
    found = [int(bus["port"])] if bus is not None else []
    found += [settings.page.port] if settings.page.port else []
    return [*found, *([address_of(settings.metrics)[1]] if settings.metrics else [])]


def refuse_held_endpoint(settings: Settings) -> None:
    """Check that the bus can be opened; an endpoint other than TCP is checked when it is opened.

    Raises:
        PortHeld: When the endpoint is taken.
    """
    endpoint = settings.bus.endpoint
    where = TCP.fullmatch(endpoint)
    if where is None:
        return
    why = _trouble(where["host"].strip("[]"), int(where["port"]))
    if why:
        raise PortHeld(
            f"cannot listen on {endpoint}: {why}; another run may hold it: end that, or set "
            "another [bus] endpoint"
        )


def refuse_held_page(settings: Settings) -> None:
    """Check that the page can be opened; a run without one needs nothing.

    Raises:
        PortHeld: When a library is missing.
        PageError: When the port is taken.
    """
    if not settings.page.port:
        return
    try:
        import websockets  # noqa: F401

        from animator.page.door import BY_SETTINGS, refuse_port
    except ImportError as error:
        raise PortHeld(
            f"the page needs {error.name}: pip install 'tritrack[page]', or set page.port = 0"
        ) from error
    refuse_port(settings.page.port, settings.page.host, BY_SETTINGS)


def refuse_held_metrics(address: str) -> None:
    """Check that metrics can be served at an address; nothing where it is empty.

    Raises:
        PortHeld: When the address is taken, or a library is missing.
    """
    if not address:
        return
    if importlib.util.find_spec("prometheus_client") is None:
        raise PortHeld(
            "the metrics need prometheus_client: pip install 'tritrack[metrics]', or take "
            "metrics out of the settings"
        )
    why = _trouble(*address_of(address))
    if why:
        raise PortHeld(
            f"cannot serve the metrics on {address}: {why}; another run may hold it: end that, or "
            "set another metrics = HOST:PORT"
        )


def _trouble(host: str, port: int) -> str:
    """Why a port cannot be opened, or ""."""
    try:
        found = socket.getaddrinfo(host, port)
        with socket.socket(found[0][0]) as trial:
            trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind(found[0][4])
    except OSError as error:
        return (error.strerror or str(error)).lower()
    return ""


def free_port() -> int:
    """A port of this machine that no program uses now, and no outgoing connection takes later.

    Raises:
        PortHeld: When none is found.
    """
    for _ in range(MOST_TRIES):
        port = PORTS.start + secrets.randbelow(len(PORTS))
        with socket.socket() as door, suppress(OSError):
            door.bind(("127.0.0.1", port))
            return port
    raise PortHeld(
        f"no free port among {MOST_TRIES} from {PORTS.start} to {PORTS[-1]}: end other programs"
    )
