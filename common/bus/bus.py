"""The bus of a site: the interface that a process uses, and how a live bus is opened."""

import json
import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, Protocol

import zenoh

from common.bus.bus_access import access_of
from common.bus.bus_keys import HUB, Part, tls_of
from common.bus.inbox import Alive, Inbox
from common.bus.live_bus import LiveBus
from common.bus.mailbox import Mailbox
from common.bus.message_codec import MAX_BYTES, Said
from common.bus.messages import Message
from common.config.part_settings import BusSettings

LEASE_MS: Final = 4000
"""Zenoh's lease, seconds (its own default is 10): a process silent for longer counts as gone.
One that was stopped for less goes on as before, and the messages to it have waited. `Presence`
notices silence sooner."""

HANDSHAKE_MS: Final = 3000
"""Seconds within which a connecting peer must prove that it is one of ours. Over a link of 0.2 s
each way, with keys, both sides need 2 s."""

ENVELOPE_BYTES: Final = 1 << 16
"""Bytes of Zenoh's own framing around a message. Anything larger than message and framing is
dropped in fragments as it arrives: reassembling a flood would cost a core."""

QUEUED: Final = 16
"""Messages that may wait for Zenoh's sending thread: the largest value it accepts; its default 2
fills at once."""

PATIENCE_US: Final = 10_000
"""How long a message waits for room in a full queue before it is dropped. Zenoh's default of 1
ms is shorter than a busy host may suspend its sending thread; for a blocked link the wait
happens once."""

RETRY_S: Final = 0.1
"""Pause between two tries to reach the hub."""

log = logging.getLogger(__name__)


class BusError(RuntimeError):
    """There is no bus: the text names the endpoint, the fault and the cure."""


class Stopped(Exception):
    """The process was asked to end while it waited for the hub; nothing is wrong."""


class Bus(Protocol):
    """The messages of a site, as one process publishes and receives them.

    The `with` that opened a bus closes it; everything that the bus handed out ends with it.
    """

    def publish(self, message: Message) -> None:
        """Publish a message to all current subscribers; under congestion it waits a moment, then
        drops."""

    def subscribe(self, kind: type[Said]) -> Inbox[Said]:
        """Receive every message of a kind that is published from now on."""

    def keep(self, kind: type[Message]) -> None:
        """Keep the newest published message of a kind for processes that start later."""

    def latest(self, kind: type[Said], timeout_s: float) -> Said | None:
        """The newest message of a kind, from the process that keeps it; None when no process has
        one.

        Subscribe first, then ask: a message published in between may arrive both ways.
        """

    def answer(self, kind: type[Said], reply: Callable[[Said], Message]) -> None:
        """Answer every question of a kind. `reply` must be quick: it runs on the bus's own
        thread."""

    def ask(self, question: Message, kind: type[Said], timeout_s: float) -> Said | None:
        """The answer to a question, of the named kind; None when no answer comes in time."""

    def announce(self, name: str) -> None:
        """Announce that the process of this name is alive, until it closes its bus or dies."""

    def watch_alive(self) -> Mailbox[Alive]:
        """Report which processes are alive already, and later each that comes or goes."""


@contextmanager
def open_hub(settings: BusSettings, room: str) -> Iterator[LiveBus]:
    """The bus of the one process that all others connect to.

    Raises:
        BusError: When the endpoint is taken or is none.
        KeysError: When the settings name keys that do not exist.
    """
    try:
        session = zenoh.open(_config(settings, HUB, room))
    except zenoh.ZError as error:
        raise BusError(
            f"cannot listen on {settings.endpoint} ({_first_line(error)}): end the run that holds "
            "it, or set another [bus] endpoint"
        ) from error
    with _bus(session, room, settings.session) as bus:
        yield bus


@contextmanager
def open_client(
    settings: BusSettings,
    room: str,
    give_up_s: float,
    part: Part = "client",
    stop: threading.Event | None = None,
) -> Iterator[LiveBus]:
    """The bus of any other process; waits up to `give_up_s` for the hub, or until `stop` is set.

    Where the settings name keys, it connects with the certificate of `part` and has its rights.

    Raises:
        BusError: When the hub does not answer at the endpoint in time.
        KeysError: When the settings name keys that do not exist.
        Stopped: When it was stopped before the hub was there.
    """
    until_s = time.monotonic() + give_up_s
    session = _reach(settings, part, room, until_s, stop or threading.Event())
    if session is None:
        raise unanswered(settings, give_up_s)
    with _bus(session, room, settings.session) as bus:
        yield bus


def unanswered(settings: BusSettings, waited_s: float) -> BusError:
    """The message for a hub that did not answer within the given time."""
    keys = f", or look at the keys: tritrack doctor --keys {settings.keys}"
    return BusError(
        f"nobody answers at {settings.endpoint} after {waited_s:g} s: start the integrator "
        f"first, or set [bus] endpoint to where it listens{keys if settings.keys else ''}"
    )


@contextmanager
def _bus(session: Any, room: str, run: str) -> Iterator[LiveBus]:
    bus = LiveBus(session, room, run)
    try:
        yield bus
    finally:
        try:
            bus.close()
        finally:
            _close(session)


def _close(session: Any) -> None:
    """Close a session: an open one keeps its process from ending.

    Zenoh raises after ten seconds on a slow or lossy link (its issue 2675); by then everything was
    sent.
    """
    try:
        session.close()
    except zenoh.ZError as error:
        log.info("the bus was left without a farewell: %s", _first_line(error))


def _reach(
    settings: BusSettings, part: Part, room: str, until_s: float, stop: threading.Event
) -> Any | None:
    config = _config(settings, part, room)
    while not stop.is_set():
        try:
            return zenoh.open(config)
        except zenoh.ZError as error:
            log.debug("%s: %s", settings.endpoint, _first_line(error))
        if time.monotonic() + RETRY_S >= until_s:
            return None
        stop.wait(RETRY_S)
    raise Stopped


def _config(settings: BusSettings, part: Part, room: str) -> zenoh.Config:
    """A session that listens and connects at one endpoint and nowhere else."""
    zenoh.init_log_from_env_or("error")
    hub, endpoint = part == HUB, settings.endpoint
    own: dict[str, Any] = {
        "mode": "router" if hub else "client",
        "listen/endpoints": [endpoint] if hub else [],
        "connect/endpoints": [] if hub else [endpoint],
        "connect/retry": {
            "period_init_ms": 100,
            "period_max_ms": 500,
            "period_increase_factor": 2,
        },
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "scouting/delay": 0,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": LEASE_MS,
        "transport/link/tx/queue/size/interactive_high": QUEUED,
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": PATIENCE_US,
        "transport/link/rx/max_message_size": MAX_BYTES + ENVELOPE_BYTES,
        "transport/unicast/open_timeout": HANDSHAKE_MS,
    }
    if settings.keys:
        own["transport/link/tls"] = tls_of(Path(settings.keys), part)
        own |= {"access_control": access_of(room)} if hub else {}
    config = zenoh.Config()
    try:
        for name, value in own.items():
            config.insert_json5(name, json.dumps(value))
    except zenoh.ZError as error:
        raise BusError(f"{endpoint} is no endpoint: write it like tcp/127.0.0.1:7447") from error
    return config


def _first_line(error: zenoh.ZError) -> str:
    return str(error).partition(" at /")[0]
