"""The metrics process: all messages as metrics and health, over HTTP."""

import threading
import time
from collections.abc import Iterable, Sequence
from typing import Any, Final

from prometheus_client.core import Metric

from common.bus.bus import Bus, open_client
from common.bus.control_messages import Cameras, Pulse
from common.bus.inbox import Inbox
from common.bus.mailbox import Mailbox
from common.bus.messages import Body, Posture
from common.bus.process import BEAT_S, READY_S, Heart, ProcessContext, process
from common.bus.rate import Pace
from common.config.settings import Settings
from common.platform.platforms import platform
from runtime.outside.health import ailments
from runtime.outside.metrics import families
from runtime.outside.metrics_server import served
from runtime.outside.run_figures import RunFigures, Told, step

HEAR_S: Final = 0.5
"""Interval of checks for the end, seconds."""
BEHIND: Final = 10
"""Lowering of its priority where cores are scarce: the tracking must not wait for it."""
PERIOD_S: Final = 1.0


class Desk:
    """The figures so far: updated by several threads, read by others."""

    def __init__(self, needed: Sequence[str], room: str) -> None:
        """No message yet; the run requires these processes."""
        self._needed, self._room = needed, room
        self._figures = RunFigures()
        self._lock = threading.Lock()

    def hear(self, box: Inbox[Any] | Mailbox[Any], stop: threading.Event) -> None:
        """Process messages immediately: a waiting one would count as late."""
        while not stop.is_set():
            told = box.take(HEAR_S)
            if told is not None:
                self.take_in(told)

    def take_in(self, told: Told) -> None:
        """Process one message."""
        with self._lock:
            self._figures = step(self._figures, told, time.monotonic())

    def metrics(self) -> Iterable[Metric]:
        """All figures."""
        return families({self._room: self._figures}, time.monotonic())

    def health(self) -> tuple[bool, Sequence[str]]:
        """Whether the run is well, and the lines about it."""
        wrong = ailments(self._figures, self._needed, time.monotonic())
        return not wrong, wrong or [f"{self._room}: well"]


def run(desk: Desk, bus: Bus, stop: threading.Event) -> None:
    """Receive all messages until stopped."""
    boxes: list[Inbox[Any] | Mailbox[Any]] = [
        *(bus.subscribe(kind) for kind in (Body, Posture, Pulse, Cameras)),
        bus.watch_alive(),
    ]
    kept = bus.latest(Cameras, HEAR_S)
    if kept is not None:
        desk.take_in(kept)
    threads = [threading.Thread(target=desk.hear, args=(box, stop)) for box in boxes]
    heart = Heart(bus, "metrics", Pace(PERIOD_S))
    heart.beat("ready")
    for thread in threads:
        thread.start()
    while not stop.wait(BEAT_S):
        heart.beat("running")
    for thread in threads:
        thread.join()
    heart.beat("ended")


def main(
    settings: Settings, needed: Sequence[str], context: ProcessContext = ProcessContext()
) -> None:
    """Serve metrics at the address in the settings until stopped.

    Args:
        settings: The run's settings.
        needed: Names of the processes that it requires.
        context: How this process runs.

    Raises:
        BusError: When the integrator does not answer.
    """
    desk = Desk(needed, settings.room)
    with process("metrics", context) as stop:
        platform().give_way(BEHIND)
        with (
            served(settings.metrics, desk.metrics, desk.health),
            open_client(settings.bus, settings.room, READY_S, "metrics", stop) as bus,
        ):
            bus.announce("metrics")
            run(desk, bus, stop)
