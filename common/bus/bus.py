"""The bus of a room: what a process may ask of it, and how a live one is opened."""

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
"""A process that hangs counts as gone after this, by Zenoh's own 10 s. One that was stopped for
less goes on where it was: what was said to it meanwhile waits. Who is silent is known sooner."""

HANDSHAKE_MS: Final = 3000
"""How long a peer that accepts a connection may take to prove that it is one of ours: over a link
that is slow by 0.2 s each way, with keys, both need 2 s for that."""

ENVELOPE_BYTES: Final = 1 << 16
"""What Zenoh's own words around a message may take. What is larger than both is dropped piece by
piece as it comes: putting together a flood of it would cost a core."""

QUEUED: Final = 16
"""Messages that may wait for Zenoh's sending thread, its most; its own 2 are soon full."""

PATIENCE_US: Final = 10_000
"""How long a message may wait for room in a full queue before it is dropped. Zenoh's own 1 ms is
less than a busy host lets its sending thread sleep; a link that is stuck is waited for once."""

RETRY_S: Final = 0.1
"""Pause between two tries to reach the hub."""

log = logging.getLogger(__name__)


class BusError(RuntimeError):
    """No bus: the text names the endpoint, the fault and the cure."""


class Stopped(Exception):
    """Whoever waited for the hub was told to end: nothing is wrong."""


class Bus(Protocol):
    """A room's messages, as one process speaks and hears them.

    A bus is closed by the `with` that opened it; all that it gave out ends with it.
    """

    def publish(self, message: Message) -> None:
        """Say a message to all who listen now; under congestion it waits a moment, then drops."""

    def subscribe(self, kind: type[Said]) -> Inbox[Said]:
        """Hear every message of a kind that is said from now on."""

    def keep(self, kind: type[Message]) -> None:
        """Hold the newest published message of a kind for those who come late."""

    def latest(self, kind: type[Said], timeout_s: float) -> Said | None:
        """The newest message of a kind, from whoever keeps it; None when nobody has one.

        Subscribe first, ask then: what is said in between may come both ways.
        """

    def answer(self, kind: type[Said], reply: Callable[[Said], Message]) -> None:
        """Answer every question of a kind; `reply` must be quick: the bus's own thread runs it."""

    def ask(self, question: Message, kind: type[Said], timeout_s: float) -> Said | None:
        """The answer to a question, of the kind named; None when nobody gives one in time."""

    def announce(self, name: str) -> None:
        """Let others know that the process of this name lives, until it closes its bus or dies."""

    def watch_alive(self) -> Mailbox[Alive]:
        """Hear who lives already, and who comes and goes."""


@contextmanager
def open_hub(settings: BusSettings, room: str) -> Iterator[LiveBus]:
    """The bus of the one process that all others connect to.

    Raises:
        BusError: When the endpoint is taken or is none.
        KeysError: When the settings name keys that are not there.
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

    Where the settings name keys it speaks as `part`, and no more than that may.

    Raises:
        BusError: When nobody answers at the endpoint in time.
        KeysError: When the settings name keys that are not there.
        Stopped: When it was stopped before the hub was there.
    """
    until_s = time.monotonic() + give_up_s
    session = _reach(settings, part, room, until_s, stop or threading.Event())
    if session is None:
        raise unanswered(settings, give_up_s)
    with _bus(session, room, settings.session) as bus:
        yield bus


def unanswered(settings: BusSettings, waited_s: float) -> BusError:
    """What is said where the hub did not answer for so long."""
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
    """Close a session: one that is open keeps its process from ending.

    Zenoh gives up after ten seconds where a link is slow or loses packets (its issue 2675); all
    has been said by then.
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
    """A session that hears and speaks at one endpoint and nowhere else."""
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
