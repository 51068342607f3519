"""A live run: its processes started, received from, supervised, and ended in order."""

import logging
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any, Final, NamedTuple

from common.bus.bus import Bus, BusError, open_client, unanswered
from common.bus.control_messages import Cameras, Pulse
from common.bus.inbox import Inbox
from common.bus.messages import Body, Message, Posture, View
from common.bus.process import READY_S
from common.config.settings import Settings
from runtime.live.page_desk import PageDesk
from runtime.live.process_table import Part
from runtime.live.recorded import MessageLog, SoFar
from runtime.live.supervise import Watched, watched
from runtime.store.journal import Journal
from runtime.store.recording import Keep

LOOK_S: Final = 0.1
TRY_S: Final = 0.3
"""Duration of each attempt to reach the integrator, seconds."""
LAST_WORDS_S: Final = 0.4
"""Longest delay of the last messages, seconds."""

log = logging.getLogger(__name__)


class Heard(NamedTuple):
    """The messages of a run, as received by its supervisor."""

    bodies: MessageLog[Body]
    postures: MessageLog[Posture]
    pulses: dict[str, Pulse]
    cameras: list[Cameras]
    notes: list[str]
    """The supervisor's own lines: which part died, and what follows."""
    so_far: SoFar
    keep: Keep | None = None
    """Receives every report, body, posture and rig, where the run is recorded."""
    journal: Journal | None = None
    """Receives every body, posture and rig at once."""


def nothing_heard() -> Heard:
    """Messages of a new run."""
    return Heard(MessageLog(Body), MessageLog(Posture), {}, [], [], SoFar())


def run(
    parts: Sequence[Part],
    settings: Settings,
    stop: threading.Event,
    show: Callable[[Heard], None],
    heard: Heard,
    desk: PageDesk | None = None,
) -> None:
    """Start the parts, receive their messages, and end them all when the run is over or stopped.

    A part that dies is restarted; the run goes on without a viewer that was given up, as long as
    another one lives.

    Args:
        parts: In the order of their start; they are stopped in the reverse order.
        settings: The run's settings.
        stop: Ends the run early.
        show: Called ten times a second with the messages so far.
        heard: Filled during the run, so that a failure loses no message.
        desk: The page's desk; the page runs already and goes on when the run is over.

    Raises:
        PartFailed: When a process fails by its own error before it ever worked, or was given up;
            the others are stopped first.
        BusError: When the integrator cannot be reached.
    """
    with ExitStack() as doors:
        hub = doors.enter_context(watched(parts[0]))
        bus = doors.enter_context(_client(settings, stop, lambda: _look_at_hub(hub, heard, show)))
        if bus is None:
            return
        listening = Subscriber(bus, heard)
        crew = [hub, *(doors.enter_context(watched(part)) for part in parts[1:])]
        if desk is not None:
            desk.listen(bus)
        try:
            while not stop.wait(LOOK_S) and not _over(crew):
                _catch_up(crew, listening, heard, desk)
                show(heard)
                if desk is not None:
                    desk.serve(heard, stop)
            time.sleep(LAST_WORDS_S)
        finally:
            _end(crew, listening, heard, desk)
            show(heard)
        if not stop.is_set():
            for one in crew:
                one.refuse_failure()


def _look_at_hub(hub: Watched, heard: Heard, show: Callable[[Heard], None]) -> None:
    """Until the hub can be reached: its process alone, without which there is no run."""
    _look_after([hub], heard)
    hub.refuse_failure()
    show(heard)


def _catch_up(
    crew: Sequence[Watched], listening: "Subscriber", heard: Heard, desk: PageDesk | None
) -> None:
    """Receive what was said, and look after every process, the page's too."""
    listening.catch_up()
    page = [] if desk is None or desk.watched is None else [desk.watched]
    _look_after([*crew, *page], heard)


def _end(
    crew: Sequence[Watched], listening: "Subscriber", heard: Heard, desk: PageDesk | None
) -> None:
    """End the parts in the reverse order of their start, and receive their last messages."""
    listening.catch_up()
    if desk is not None:
        desk.leave(heard)
    heard.notes.extend(filter(None, [one.end() for one in reversed(crew)]))
    listening.catch_up()
    if listening.dropped:
        heard.notes.append(
            f"{listening.dropped} poses or postures were lost on the way to the run folder"
        )


def _look_after(crew: Sequence[Watched], heard: Heard) -> None:
    """Restart dead parts, and report it; all messages come through the integrator."""
    hub = next(one for one in crew if one.part.name == "integrator")
    for one in crew:
        told = one.look(time.monotonic(), heard.pulses, reached=one is hub or hub.speaks)
        if told:
            log.warning(told)
            heard.notes.append(told)


def _over(crew: Sequence[Watched]) -> bool:
    """Whether every viewer has ended or was given up, or a required part was given up."""
    leads = [one for one in crew if one.part.leads]
    needed = any(one.given_up for one in crew if not (one.part.leads or one.part.spare))
    return needed or all(one.done or one.given_up for one in leads)


class Subscriber:
    """Gathers messages into a Heard."""

    def __init__(self, bus: Bus, heard: Heard) -> None:
        """Subscribe from now on; the rig may have been published before."""
        self._heard, self._keep = heard, heard.keep
        self._bodies = bus.subscribe(Body)
        self._postures = bus.subscribe(Posture)
        self._pulses = bus.subscribe(Pulse)
        self._cameras = bus.subscribe(Cameras)
        told = bus.latest(Cameras, LAST_WORDS_S)
        heard.cameras.extend([] if told is None else [told])
        if heard.journal is not None:
            heard.journal.keep(heard.cameras)
        self._reports = [bus.subscribe(View)] if heard.keep is not None else []

    @property
    def dropped(self) -> int:
        """Number of reports, bodies and postures that were lost."""
        boxes: tuple[Inbox[Any], ...] = (self._bodies, self._postures, *self._reports)
        return sum(box.dropped for box in boxes)

    def catch_up(self) -> None:
        """Process all messages since the last call."""
        said: list[list[Any]] = [box.drain() for box in self._reports]
        bodies, postures, cameras = (
            self._bodies.drain(),
            self._postures.drain(),
            self._cameras.drain(),
        )
        self._heard.bodies.add(bodies)
        self._heard.postures.add(postures)
        self._heard.cameras.extend(cameras)
        self._heard.so_far.take(bodies, postures)
        if self._heard.journal is not None:
            self._heard.journal.keep([*cameras, *bodies, *postures])
            self._note(self._heard.journal.odd)
        self._record([each for some in [*said, cameras, bodies, postures] for each in some])
        for pulse in self._pulses.drain():
            self._heard.pulses[pulse.process] = pulse

    def _record(self, messages: list[Message]) -> None:
        """Record messages for a replay, until the disk is full: the run goes on without."""
        if self._keep is None:
            return
        try:
            for message in messages:
                self._keep(message)
        except OSError as error:
            self._keep = None
            self._note([f"the recording ends here: it cannot be written ({error.strerror})"])

    def _note(self, lines: list[str]) -> None:
        """Print the news among these."""
        self._heard.notes.extend(line for line in lines if line not in self._heard.notes)


@contextmanager
def _client(
    settings: Settings, stop: threading.Event, look: Callable[[], None]
) -> Iterator[Bus | None]:
    """The supervisor's own session on the bus, as soon as the hub's process has opened it.

    None when the run was stopped before that; `look` is called between two attempts.

    Raises:
        BusError: When it does not open.
    """
    until_s = time.monotonic() + READY_S
    bus: Bus | None = None
    with ExitStack() as door:
        while bus is None and not stop.is_set():
            look()
            try:
                bus = door.enter_context(
                    open_client(settings.bus, settings.room, TRY_S, "supervisor")
                )
            except BusError as error:
                if time.monotonic() > until_s:
                    raise unanswered(settings.bus, READY_S) from error
        yield bus
