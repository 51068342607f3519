"""What every process of a run does: end on a signal, report its state, write a log."""

import ctypes
import gc
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

import cv2
import psutil

from common.bus.bus import Bus, Stopped
from common.bus.control_messages import Pulse
from common.bus.rate import Pace
from common.heeded_signals import heeding
from common.platform.platforms import platform

BEAT_S: Final = 1.0
READY_S: Final = 60.0
"""How long processes wait for each other at the start: a first run compiles for some seconds."""
PAGE_S: Final = 30.0
"""How long a clip waits for the page to be opened, once all else is ready."""
BEGIN_S: Final = READY_S + PAGE_S
"""How long a ready viewer waits for the run to begin."""
HANG_UP: Final[signal.Signals | None] = getattr(signal, "SIGHUP", None)
"""The signal of a closed terminal; None where the system has none."""
SUPERVISING: Final = (
    ".".join([*__name__.split(".")[:-3], "runtime"]),
    "tritrack.__main__",
)
"""Loggers of the processes that run the parts; parts that are threads of a process log by their
own names."""


class ProcessContext(NamedTuple):
    """How a process was started, and where it leaves its state and log."""

    supervised: bool = False
    """True where a supervisor started it, which alone handles Ctrl-C and asks it to end."""
    log: Path | None = None
    """The run's log; None: the terminal."""
    kept: Path | None = None
    """Folder of this run in which a process leaves its state for its successor; None: it has
    none."""
    pictures: Path | None = None
    """Folder in which viewers keep what their cameras show; None: no picture is kept."""
    stop: threading.Event | None = None
    """Event that ends the part, where the part is a thread of its supervisor's process; None: it
    has its own process."""


@contextmanager
def process(name: str, context: ProcessContext) -> Iterator[threading.Event]:
    """An event that is set when the process shall end; meanwhile each library uses one thread.

    A process that waits for the bus then leaves the `with` at once.
    """
    cv2.setNumThreads(1)
    if context.stop is not None:  # signals and log belong to the whole process
        with suppress(Stopped):
            yield context.stop
        return
    stop = threading.Event()
    interrupted = (
        nullcontext() if context.supervised else heeding(lambda _: stop.set(), signal.SIGINT)
    )
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    start_log(name, context.log)
    try:
        with interrupted, platform().asked_to_end(stop.set), suppress(Stopped):
            yield stop
    finally:
        signal.signal(signal.SIGINT, before)


def start_log(name: str, path: Path | None, level: int | str | None = None) -> None:
    """Write this process's log to a file that all processes append to, or to the terminal."""
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
    logging.basicConfig(
        filename=path,
        level=level or os.environ.get("TRITRACK_LOG", "INFO").upper(),
        format=_format(name),
        force=True,
    )


@contextmanager
def logged(name: str, path: Path) -> Iterator[None]:
    """Send the supervisor's log to the run's log alone: its terminal shows the same in words."""
    handler, ours = logging.FileHandler(path), [logging.getLogger(each) for each in SUPERVISING]
    handler.setFormatter(logging.Formatter(_format(name)))
    for logger in ours:
        logger.addHandler(handler)
        logger.propagate = False
    try:
        yield
    finally:
        for logger in ours:
            logger.propagate = True
            logger.removeHandler(handler)
        handler.close()


def _format(name: str) -> str:
    return f"%(asctime)s {name:<11} %(levelname)-7s %(message)s"


class Heart:
    """Reports once a second how a process is doing."""

    def __init__(self, bus: Bus, name: str, pace: Pace) -> None:
        """`pace` counts the process's frames."""
        self._bus, self._name, self._pace = bus, name, pace
        self._next_s = 0.0
        self._self = psutil.Process()

    def hurry(self) -> None:
        """Allow the next pulse at once, although the last one is recent: there is news."""
        self._next_s = 0.0

    def beat(
        self,
        state: Literal["starting", "ready", "running", "ended"],
        detail: str = "",
        **counts: Any,
    ) -> None:
        """Publish a Pulse if the last one is a second old, or if this one is special."""
        now_s = time.monotonic()
        if state == "running" and now_s < self._next_s:
            return
        self._next_s = now_s + BEAT_S
        self._bus.publish(
            Pulse(
                process=self._name,
                state=state,
                detail=detail,
                frames=self._pace.frames,
                fps=self._pace.fps,
                deadline_misses=self._pace.misses,
                latency_p50_ms=self._pace.latency_ms(0.5),
                latency_p99_ms=self._pace.latency_ms(0.99),
                memory_mb=self._memory_mb(),
                **counts,
            )
        )

    def _memory_mb(self) -> float:
        """This process's memory; a thread of its supervisor's process has none of its own."""
        if threading.current_thread() is not threading.main_thread():
            return 0.0
        return float(self._self.memory_info().rss / 1e6)


def settle() -> None:
    """Give loading's temporary memory back, and exclude what stays from garbage collection.

    Memory that loading freed lies in holes of the heap, which glibc keeps: 10 to 30 MB in each of a
    room's eight processes.
    """
    gc.collect()
    gc.freeze()
    if sys.platform == "linux":
        with suppress(AttributeError):  # not glibc
            ctypes.CDLL(None).malloc_trim(0)
