"""tritrack in a program of one's own: bodies from images, from a clip, or from a live run."""

import asyncio
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Final, Generic, TypeVar, overload

import msgspec

from common.body.body import ANGLE_NAMES, JOINT_NAMES, POSE_INDEX
from common.bus.messages import Body, Message, Posture, View, ViewerNumber
from common.config.config_file import load
from common.config.part_settings import BusSettings
from common.config.settings import Settings

if TYPE_CHECKING:
    from common.bus.bus import Bus
    from runtime.store.past_run import PastRun

__all__ = [
    "ANGLE_NAMES",
    "JOINT_NAMES",
    "POSE_INDEX",
    "Body",
    "Posture",
    "Subscription",
    "View",
    "load_run",
    "subscribe",
    "track",
]

Said = TypeVar("Said", bound=Message)

ENDPOINT: Final = BusSettings().endpoint
ROOM: Final = Settings().room
WAIT_S: Final = 60.0
LOOK_S: Final = 0.2
"""Interval, seconds, at which a silent run is checked for its end."""
HUB: Final = "integrator"


def track(source: str | Path, views: tuple[ViewerNumber, ...] | None = None) -> list[Body]:
    """Track a recorded clip: the bodies that `tritrack track` writes, one per frame.

    Examples:
        >>> from tritrack import track
        >>> bodies = track(clip)  # its folder
        >>> bodies[0].status, bodies[40].status
        ('empty', 'tracking')
        >>> len(bodies[40].joints_m)  # as JOINT_NAMES, metres
        15

    Args:
        source: A clip folder (cam1.*, cam2.* ...), or a settings file (TOML).
        views: Numbers of the cameras to use; None: all.

    NumPy's products use one thread meanwhile: two would wait for each other at every frame.

    Raises:
        SettingsError, ClipError, DecoderDied: When the clip cannot be used; the text says why.
    """
    from threadpoolctl import threadpool_limits

    from runtime.offline.lockstep import Decoders, track_clip

    with threadpool_limits(1), Decoders() as decoders:
        return list(track_clip(load(Path(source)), decoders, views).bodies)


def load_run(folder: str | Path, person: int | None = None) -> "PastRun":
    """Read a run folder: its poses as arrays, its summary.

    Examples:
        >>> from tritrack import load_run
        >>> run = load_run(folder)
        >>> run.poses["joints_m"].shape
        (69, 15, 3)
        >>> run.summary["scale_source"]
        'calibrated'

    Args:
        folder: Written by `tritrack track`, `single` or `live`, complete or cut short.
        person: Number of the person whose rows to give; None: all rows, `poses["person"]` says
            whose. The summary is that of the run.

    Raises:
        PastRunError: When it is no run folder, is damaged, is of a newer version, or has no such
            person.
    """
    from runtime.store.past_run import open_run
    from runtime.store.run_people import of_person

    run = open_run(Path(folder))
    return run if person is None else of_person(run, person)


@overload
def subscribe(
    endpoint: str = ENDPOINT,
    room: str = ROOM,
    *,
    wait_s: float = WAIT_S,
    keys: str = "",
    person: int | None = None,
) -> "Subscription[Body]": ...
@overload
def subscribe(
    endpoint: str = ENDPOINT,
    room: str = ROOM,
    *,
    kind: type[Said],
    wait_s: float = WAIT_S,
    keys: str = "",
    person: int | None = None,
) -> "Subscription[Said]": ...
def subscribe(
    endpoint: str = ENDPOINT,
    room: str = ROOM,
    *,
    kind: type[msgspec.Struct] = Body,
    wait_s: float = WAIT_S,
    keys: str = "",
    person: int | None = None,
) -> "Subscription":  # type: ignore[type-arg]
    """Messages of a live run, for `for` and `async for`, until the run is over.

    Examples:
        >>> from tritrack import subscribe
        >>> frames = []
        >>> for body in subscribe(endpoint):  # as `[bus] endpoint` of the run's settings
        ...     frames.append(body.frame)
        >>> frames[-1]  # the run is over
        119

    Args:
        endpoint: Where the integrator listens, `[bus] endpoint` of the run's settings.
        room: `room` of the run's settings.
        kind: Kind of message: Body, Posture or View.
        wait_s: How long to wait for the run to begin.
        keys: Folder with ca.pem, client.pem and client.key, where the run has keys; the endpoint is
            tls/HOST:PORT then.
        person: Number of the person whose messages to give; None: everyone's. A View shows all.

    Raises:
        SettingsError: When only one of keys and endpoint is of TLS.
        ValueError: When a person is asked for of a kind that has none.
    """
    if person is not None and "person" not in kind.__struct_fields__:
        raise ValueError(f"a {kind.__name__} is of no one person: leave person out")
    bus = BusSettings(endpoint=endpoint, keys=keys, open_to_all=True)
    return Subscription(kind, bus, room, wait_s, person)


class Subscription(Generic[Said]):
    """A live run's messages of one kind; each loop over it opens its own subscription.

    A loop that is slower than the run loses the oldest of 256 waiting messages, never the newest.
    It ends with the integrator. It raises BusError when there is no run in time.
    """

    def __init__(
        self,
        kind: type[Said],
        bus: BusSettings,
        room: str,
        wait_s: float,
        person: int | None = None,
    ) -> None:
        """See `subscribe`."""
        self._kind, self._bus, self._room, self._wait_s = kind, bus, room, wait_s
        self._person = person

    def __iter__(self) -> Iterator[Said]:
        """Subscribe from now on."""
        with ExitStack() as doors:
            ears = self._listen(doors)
            while (message := ears.take()) is not None or not ears.over:
                if message is not None and self._is_wanted(message):
                    yield message

    async def __aiter__(self) -> AsyncIterator[Said]:
        """Subscribe from now on; the event loop is not blocked."""
        with ExitStack() as doors:
            ears = await asyncio.to_thread(self._listen, doors)
            while (message := await asyncio.to_thread(ears.take)) is not None or not ears.over:
                if message is not None and self._is_wanted(message):
                    yield message

    def _is_wanted(self, message: Said) -> bool:
        return self._person is None or getattr(message, "person", None) == self._person

    def _listen(self, doors: ExitStack) -> "_Ears[Said]":
        from common.bus.bus import open_client

        bus = doors.enter_context(open_client(self._bus, self._room, self._wait_s))
        return _Ears(bus, self._kind, time.monotonic() + self._wait_s)


class _Ears(Generic[Said]):
    """An open subscription, and whether its run is over."""

    def __init__(self, bus: "Bus", kind: type[Said], give_up_s: float) -> None:
        self._inbox, self._alive = bus.subscribe(kind), bus.watch_alive()
        self._give_up_s = give_up_s
        self._there = False

    def take(self) -> Said | None:
        """The next message; None where none comes for a moment."""
        return self._inbox.take(LOOK_S)

    @property
    def over(self) -> bool:
        """Whether the integrator left, or never came."""
        for alive in self._alive.drain():
            if alive.name == HUB:
                self._there = alive.alive
                self._give_up_s = 0.0
        return not self._there and time.monotonic() > self._give_up_s
