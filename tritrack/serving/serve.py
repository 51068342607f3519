"""Serving sites: started, watched over, changed when their file changes, and ended together."""

import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from types import FrameType
from typing import Any, Final

from rich.console import Console
from rich.live import Live as LiveDisplay

from common.bus.control_messages import Pulse
from common.config import SettingsError
from tritrack.live.free_ports import refuse_held_metrics, refuse_held_ports, with_free_endpoint
from tritrack.live.table import table_of
from tritrack.serving.room import Room
from tritrack.serving.site_changes import changes
from tritrack.serving.sites import Site, Sites, load_sites
from tritrack.terminal import warn

LOOK_S: Final = 0.1
CHANGED_S: Final = 1.0
"""How often is looked whether a file has changed."""


class House:
    """The rooms that are served, by their names."""

    def __init__(self, say: Callable[[str], None], lament: Callable[[str], None]) -> None:
        """None yet; each piece of news is said, what went wrong is lamented."""
        self._rooms: dict[str, Room] = {}
        self._states: dict[str, str] = {}
        self._say, self._lament = say, lament

    @property
    def pulses(self) -> dict[str, Pulse]:
        """The newest of each room."""
        pulses = {name: room.pulse for name, room in self._rooms.items()}
        return {name: pulse for name, pulse in pulses.items() if pulse is not None}

    @property
    def names(self) -> list[str]:
        """Of the rooms."""
        return list(self._rooms)

    def become(self, wanted: Mapping[str, Site]) -> None:
        """Stop, start and change what is not as it shall be; leave the others alone."""
        stop, start = changes(wanted, {name: room.site for name, room in self._rooms.items()})
        self._end([self._rooms.pop(name) for name in stop])
        for site in start:
            self._rooms[site.name] = Room(site)

    def look(self) -> None:
        """See how each room is; what died is started again."""
        for room in self._rooms.values():
            told = room.look(time.monotonic())
            if told:
                self._lament(told)
            self._tell_state(room)

    def end(self) -> None:
        """End all, at once."""
        self._end(list(self._rooms.values()))
        self._rooms.clear()

    def health(self) -> tuple[bool, Sequence[str]]:
        """Whether all rooms are well, and a line of each."""
        found = [room.status for room in list(self._rooms.values())]
        return all(status.well for status in found), [status.line for status in found]

    def metrics(self) -> Iterable[Any]:
        """The figures of all rooms."""
        from tritrack.outside.metrics import families

        figures = {name: room.figures for name, room in list(self._rooms.items())}
        return families(figures, time.monotonic())

    def _tell_state(self, room: Room) -> None:
        """Say how a room is, where that is another state than before."""
        name = room.site.name
        if room.pulse is not None and self._states.get(name) != room.pulse.state:
            self._states[name] = room.pulse.state
            self._say(room.status.line)

    def _end(self, rooms: Sequence[Room]) -> None:
        for room in rooms:
            room.ask()
        for room in rooms:
            room.end()
            self._states.pop(room.site.name, None)
            self._say(f"{room.site.name}: stopped; its run is in {room.site.out}")


def serve(path: Path, console: Console) -> None:
    """Serve the sites of a file until SIGINT or SIGTERM; SIGHUP reads it anew.

    Args:
        path: Of the file.
        console: Shows a table of the sites, and what happens.

    Raises:
        SettingsError, PortHeld, PageError: When the file cannot be used; nothing was started.
    """
    sites = load_sites(path)
    refuse_held_metrics(sites.metrics)
    for site in sites.sites.values():
        refuse_held_ports(with_free_endpoint(site.settings))
    with _signals() as (stop, anew), LiveDisplay(console=console, transient=True) as display:
        house = House(
            lambda told: console.print(told, markup=False, highlight=False, soft_wrap=True),
            lambda told: warn(console, told),
        )
        seen, look_s = _state_of(sites), 0.0
        try:
            house.become(sites.sites)
            with _answers(sites, house):
                while not stop.wait(LOOK_S):
                    house.look()
                    display.update(table_of(house.names, house.pulses, str(path)))
                    if time.monotonic() >= look_s:
                        look_s = time.monotonic() + CHANGED_S
                        if anew.is_set() or _state_of(sites) != seen:
                            anew.clear()
                            sites = _again(path, sites, console)
                            seen = _state_of(sites)
                            house.become(sites.sites)
        finally:
            house.end()


def _again(path: Path, sites: Sites, console: Console) -> Sites:
    """The sites as the file now has them; those of before where it cannot be used."""
    try:
        return load_sites(path)
    except SettingsError as error:
        warn(console, f"all sites go on as they were: {error}")
        return sites


def _state_of(sites: Sites) -> list[tuple[int, int] | None]:
    """By what is seen that a file has changed."""
    return [_stamp(path) for path in sites.files]


def _stamp(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def _answers(sites: Sites, house: House) -> AbstractContextManager[None]:
    """Metrics and health of all sites by HTTP, where that is wanted."""
    if not sites.metrics:
        return nullcontext()
    from tritrack.outside.metrics_server import served

    return served(sites.metrics, house.metrics, house.health)


@contextmanager
def _signals() -> Iterator[tuple[threading.Event, threading.Event]]:
    """Set by SIGINT and SIGTERM, and by SIGHUP."""
    stop, anew = threading.Event(), threading.Event()

    def heed(number: int, _frame: FrameType | None) -> None:
        (anew if number == signal.SIGHUP else stop).set()

    heeded = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, heed) for number in heeded}
    try:
        yield stop, anew
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
