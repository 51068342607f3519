"""The metrics process: everything that is said, as figures and health for who asks by HTTP."""

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
"""So soon it is seen that the process shall end."""
BEHIND: Final = 10
"""How far it stands back when cores are scarce: no pose waits for it."""
PERIOD_S: Final = 1.0


class Desk:
    """The figures so far: taken in by several threads, given to others."""

    def __init__(self, needed: Sequence[str], room: str) -> None:
        """Nothing heard yet; these processes the run cannot do without."""
        self._needed, self._room = needed, room
        self._figures = RunFigures()
        self._lock = threading.Lock()

    def hear(self, box: Inbox[Any] | Mailbox[Any], stop: threading.Event) -> None:
        """Take in what comes, at once: what waited would count as late."""
        while not stop.is_set():
            told = box.take(HEAR_S)
            if told is not None:
                self.take_in(told)

    def take_in(self, told: Told) -> None:
        """One message."""
        with self._lock:
            self._figures = step(self._figures, told, time.monotonic())

    def metrics(self) -> Iterable[Metric]:
        """All figures."""
        return families({self._room: self._figures}, time.monotonic())

    def health(self) -> tuple[bool, Sequence[str]]:
        """Whether the run is well, and what is to be said of that."""
        wrong = ailments(self._figures, self._needed, time.monotonic())
        return not wrong, wrong or [f"{self._room}: well"]


def run(desk: Desk, bus: Bus, stop: threading.Event) -> None:
    """Hear everything until stopped."""
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
    """Answer at the address that the settings name, and hear the run, until stopped.

    Args:
        settings: Of the run.
        needed: Names of the processes that it cannot do without.
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
