"""A live run: the table of its processes, their supervision, and what it leaves behind."""

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Final, NamedTuple

from common.bus import Bus, BusError, open_client
from common.clips import Clip
from common.config import Settings
from common.messages import Body, Cameras, Posture, Pulse
from common.process import READY_S, Place

SPAWN: Final = multiprocessing.get_context("spawn")
"""Never fork: Zenoh's threads are not inherited."""
END_S: Final = 5.0
"""How long a process may take to close its doors before it is killed."""
LOOK_S: Final = 0.1
LAST_WORDS_S: Final = 0.4
"""What was said last is on its way for no longer than this."""
ONE_THREAD: Final = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


class PartFailed(RuntimeError):
    """A process of the run failed; the text names it and says why."""


class Part(NamedTuple):
    """One process of a run."""

    name: str
    main: Callable[..., None]
    arguments: tuple[Any, ...]
    leads: bool = False
    """The run is over when all that lead have ended."""


class Running(NamedTuple):
    """A part that was started."""

    part: Part
    process: BaseProcess
    words: Connection
    """On which it says why it fails."""


class Heard(NamedTuple):
    """What a run said, as its supervisor heard it."""

    bodies: list[Body]
    postures: list[Posture]
    pulses: dict[str, Pulse]
    cameras: list[Cameras]


def live_parts(settings: Settings, clip: Clip, place: Place) -> list[Part]:
    """The table of a live run: who listens comes before who speaks (P2)."""
    period_s = clip.every / clip.views[0].fps
    parts = [
        Part("integrator", integrator_main, (settings, clip, place)),
        Part("recognizer", recognizer_main, (settings, period_s, place)),
    ]
    if settings.page.port:
        parts.append(Part("animator", animator_main, (settings, clip.rig, period_s, place)))
    for view in clip.views:
        arguments = (settings, view.number, place)
        parts.append(Part(f"viewer {view.number}", viewer_main, arguments, leads=True))
    return parts


def integrator_main(*arguments: Any) -> None:
    """The integrator, imported where it runs."""
    from integrator.__main__ import main

    main(*arguments)


def recognizer_main(*arguments: Any) -> None:
    """The recognizer, imported where it runs."""
    from recognizer.__main__ import main

    main(*arguments)


def animator_main(*arguments: Any) -> None:
    """The animator, imported where it runs."""
    from animator.__main__ import main

    main(*arguments)


def viewer_main(*arguments: Any) -> None:
    """A viewer, imported where it runs."""
    from viewer.__main__ import main

    main(*arguments)


def run(
    parts: Sequence[Part],
    settings: Settings,
    stop: threading.Event,
    show: Callable[[dict[str, Pulse]], None],
    heard: Heard,
) -> None:
    """Start the parts, listen to them, and end them all when the run is over or stopped.

    Args:
        parts: In the order of their start; they are stopped in the reverse order.
        settings: Of the run.
        stop: Ends the run early.
        show: Called ten times a second with the newest pulse of each process.
        heard: Filled as the run goes, so that a failure loses nothing that was said.

    Raises:
        PartFailed: When a process ends with an error; the others are stopped first.
        BusError: When the integrator cannot be reached.
    """
    with ExitStack() as doors:
        hub = doors.enter_context(_started(parts[0]))
        bus = doors.enter_context(_client(settings, hub, stop))
        if bus is None:
            return
        listening = Ears(bus, heard)
        running = [hub, *(doors.enter_context(_started(part)) for part in parts[1:])]
        try:
            while not stop.wait(LOOK_S):
                listening.catch_up()
                show(heard.pulses)
                _refuse_failures(running)
                if all(one.process.exitcode == 0 for one in running if one.part.leads):
                    break
            time.sleep(LAST_WORDS_S)
        finally:
            for one in reversed(running):
                _end(one)
            listening.catch_up()
            show(heard.pulses)
        if not stop.is_set():
            _refuse_failures(running)


class Ears:
    """Gathers what is said into a Heard."""

    def __init__(self, bus: Bus, heard: Heard) -> None:
        """Listen from now on; the cameras may have been told before."""
        self._heard = heard
        self._bodies = bus.subscribe(Body)
        self._postures = bus.subscribe(Posture)
        self._pulses = bus.subscribe(Pulse)
        self._cameras = bus.subscribe(Cameras)
        told = bus.latest(Cameras, LAST_WORDS_S)
        heard.cameras.extend([] if told is None else [told])

    def catch_up(self) -> None:
        """Take in all that was said since."""
        self._heard.bodies.extend(self._bodies.drain())
        self._heard.postures.extend(self._postures.drain())
        self._heard.cameras.extend(self._cameras.drain())
        for pulse in self._pulses.drain():
            self._heard.pulses[pulse.process] = pulse


@contextmanager
def _started(part: Part) -> Iterator[Running]:
    """A part's process, from its start to its end."""
    ours, theirs = SPAWN.Pipe(duplex=False)
    process = SPAWN.Process(name=part.name, target=_guarded, args=(part, theirs), daemon=True)
    with _inherited():
        process.start()
    theirs.close()
    running = Running(part, process, ours)
    try:
        yield running
    finally:
        _end(running)


@contextmanager
def _inherited() -> Iterator[None]:
    """What a process takes over from its supervisor: one thread a library, and deaf to Ctrl-C.

    A terminal sends Ctrl-C to all processes; only the supervisor, who ends the others in order,
    shall hear it, also while they are still importing.
    """
    resource_tracker.ensure_running()  # its own start would lift the block again
    before = dict(os.environ)
    os.environ.update(ONE_THREAD)
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        os.environ.clear()
        os.environ.update(before)


@contextmanager
def _client(settings: Settings, hub: Running, stop: threading.Event) -> Iterator[Bus | None]:
    """The supervisor's own place on the bus, as soon as the hub's process has opened it.

    None when the run was stopped before that.

    Raises:
        PartFailed: When the hub failed instead.
        BusError: When it does not open.
    """
    until_s = time.monotonic() + READY_S
    bus: Bus | None = None
    with ExitStack() as door:
        while bus is None and not stop.is_set():
            _refuse_failures([hub])
            try:
                bus = door.enter_context(open_client(settings.bus, settings.room, 1.0))
            except BusError:
                if time.monotonic() > until_s:
                    raise
        yield bus


def _guarded(part: Part, words: Connection) -> None:
    """Run a part; what it cannot do is said in one line, not in a traceback."""
    try:
        part.main(*part.arguments)
    except Exception as error:
        logging.getLogger(part.name).debug("failed", exc_info=error)
        words.send(str(error) or type(error).__name__)
        raise SystemExit(2) from None


def _end(one: Running) -> None:
    """Ask, wait, then kill."""
    if one.process.is_alive():
        one.process.terminate()
        one.process.join(END_S)
    if one.process.is_alive():
        one.process.kill()
        one.process.join()


def _refuse_failures(running: Sequence[Running]) -> None:
    for one in running:
        if one.process.exitcode:
            raise PartFailed(f"{one.part.name}: {_last_words(one)}")


def _last_words(one: Running) -> str:
    """Why a process ended; one that was killed says nothing."""
    try:
        if one.words.poll():
            return str(one.words.recv())
    except EOFError:
        pass
    code = one.process.exitcode or 0
    return f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
