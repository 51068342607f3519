"""All served rooms: their wanted and their present state."""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Self

from common.bus.control_messages import Pulse
from common.platform.platform import Launcher
from runtime.serving.room import Room
from runtime.serving.site_changes import changes
from runtime.serving.sites import Site


class House:
    """The served rooms, by name."""

    def __init__(
        self, launcher: Launcher, say: Callable[[str], None], lament: Callable[[str], None]
    ) -> None:
        """None yet; each piece of news is printed, and each error."""
        self._launcher = launcher
        self._rooms: dict[str, Room] = {}
        self._states: dict[str, str] = {}
        self._say, self._lament = say, lament

    def __enter__(self) -> Self:
        """All rooms end with the `with`."""
        return self

    def __exit__(self, *_: object) -> None:
        """End all, at once."""
        self._end(list(self._rooms.values()))

    @property
    def pulses(self) -> dict[str, Pulse]:
        """The newest pulse of each room."""
        pulses = {name: room.pulse for name, room in self._rooms.items()}
        return {name: pulse for name, pulse in pulses.items() if pulse is not None}

    @property
    def names(self) -> list[str]:
        """The rooms' figures."""
        return list(self._rooms)

    def become(self, wanted: Mapping[str, Site]) -> None:
        """Stop, start and change rooms until they are as wanted; leave the others alone."""
        stop, start = changes(wanted, {name: room.site for name, room in self._rooms.items()})
        self._end([self._rooms.pop(name) for name in stop])
        for site in start:
            self._rooms[site.name] = Room(site, self._launcher)

    def look(self) -> None:
        """Check each room; one that died is restarted."""
        for room in self._rooms.values():
            told = room.look(time.monotonic())
            if told:
                self._lament(told)
            self._tell_state(room)

    def health(self) -> tuple[bool, Sequence[str]]:
        """Whether all rooms are well, and a line for each."""
        found = [room.status for room in list(self._rooms.values())]
        return all(status.well for status in found), [status.line for status in found]

    def metrics(self) -> Iterable[Any]:
        """The figures of all rooms."""
        from runtime.outside.metrics import families

        figures = {name: room.figures for name, room in list(self._rooms.items())}
        return families(figures, time.monotonic())

    def _tell_state(self, room: Room) -> None:
        """Report a room's state, where it has changed."""
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
            out = room.site.out.resolve()
            where = f"; its run is in {out}" if out.is_dir() else ", before it had begun a run"
            self._say(f"{room.site.name}: stopped{where}")
