"""The rooms that are served, together: begun, changed and ended as their file says, and told of."""

from pathlib import Path
from typing import Any

import pytest

from common.bus.control_messages import Pulse
from common.config.settings import Settings
from runtime.outside.run_figures import RunFigures, step
from runtime.serving import served_rooms
from runtime.serving.served_rooms import House
from runtime.serving.site_status import status_of
from runtime.serving.sites import Site

CALLS: list[tuple[str, str]] = []


class Hall:
    """A room without a process: it says what it is told to."""

    def __init__(self, site: Site, zygote: object) -> None:
        assert zygote == "zygote"
        self.site, self.figures = site, RunFigures()
        self.pulse: Pulse | None = None
        self.failure = self.news = ""
        self.looked_s = list[float]()
        CALLS.append(("begin", site.name))

    @property
    def status(self) -> Any:
        return status_of(self.site.name, self.pulse, self.failure)

    def look(self, now_s: float) -> str:
        self.looked_s.append(now_s)
        return self.news

    def ask(self) -> None:
        CALLS.append(("ask", self.site.name))

    def end(self) -> None:
        CALLS.append(("end", self.site.name))


class Told:
    """A house, what it said and what it lamented."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.said, self.lamented = list[str](), list[str]()
        monkeypatch.setattr(served_rooms, "Room", Hall)
        monkeypatch.setattr("runtime.serving.served_rooms.time.monotonic", lambda: 41.0)
        zygote: Any = "zygote"
        self.house = House(zygote, self.said.append, self.lamented.append)
        CALLS.clear()

    def room(self, name: str) -> Hall:
        found: Any = self.house._rooms[name]
        assert isinstance(found, Hall)
        return found


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> Told:
    return Told(monkeypatch)


def site(name: str, **more: Any) -> Site:
    return Site(name, Settings(**more), Path("nowhere") / name)


def running(name: str, state: Any = "running") -> Pulse:
    return Pulse(process=name, state=state, fps=15.0, latency_p99_ms=21.4, memory_mb=410.0)


def test_a_site_that_changed_is_begun_anew_and_the_others_are_left_alone(told: Told) -> None:
    """All that end are asked before one is waited for."""
    told.house.become({name: site(name) for name in ("hall", "attic", "yard")})
    assert CALLS == [("begin", "hall"), ("begin", "attic"), ("begin", "yard")]
    hall = told.room("hall")
    CALLS.clear()
    told.house.become({"hall": site("hall"), "attic": site("attic", every=2), "den": site("den")})
    assert [
        *(("ask", "attic"), ("ask", "yard"), ("end", "attic"), ("end", "yard")),
        *(("begin", "attic"), ("begin", "den")),
    ] == CALLS
    assert told.room("hall") is hall
    assert told.room("attic").site.settings.every == 2
    assert told.house.names == ["hall", "attic", "den"]
    assert told.said == [
        "attic: stopped, before it had begun a run",
        "yard: stopped, before it had begun a run",
    ]
    CALLS.clear()
    with told.house as house:
        assert house is told.house
    assert CALLS[:3] == [("ask", "hall"), ("ask", "attic"), ("ask", "den")]
    assert CALLS[3:] == [("end", "hall"), ("end", "attic"), ("end", "den")]


def test_each_state_of_a_room_is_said_once_and_what_goes_wrong_is_lamented(told: Told) -> None:
    told.house.become({"hall": site("hall"), "attic": site("attic")})
    told.house.look()
    assert (told.said, told.lamented) == ([], [])
    assert told.room("attic").looked_s == [41.0]
    told.room("hall").pulse = running("hall", "ready")
    told.room("attic").news = "attic: down: no camera"
    told.house.look()
    told.house.look()
    counts = "15.0 frames a second, p99 21 ms, 0 missed, 410 MB"
    assert told.said == [f"hall: ready, {counts}"]
    assert told.lamented == ["attic: down: no camera"] * 2
    told.room("hall").pulse = running("hall")
    told.house.look()
    assert told.said[1:] == [f"hall: running, {counts}"]
    assert told.house.pulses == {"hall": running("hall")}


def test_a_room_that_is_begun_anew_tells_its_state_again(told: Told) -> None:
    told.house.become({"hall": site("hall")})
    told.room("hall").pulse = running("hall")
    told.house.look()
    told.house.become({"hall": site("hall", every=2)})
    told.room("hall").pulse = running("hall")
    told.said.clear()
    told.house.look()
    assert [line.partition(",")[0] for line in told.said] == ["hall: running"]


def test_all_are_well_where_each_is_and_each_has_a_line(told: Told) -> None:
    assert told.house.health() == (True, [])
    told.house.become({"hall": site("hall"), "attic": site("attic")})
    told.room("hall").pulse = running("hall")
    well, lines = told.house.health()
    assert not well
    assert [line.partition(",")[0] for line in lines] == ["hall: running", "attic: starting"]
    told.room("attic").pulse = running("attic", "ended")
    assert told.house.health()[0]
    told.room("hall").failure = "no clip"
    assert told.house.health() == (False, ["hall: down: no clip", told.house.health()[1][1]])


def test_the_figures_of_each_room_bear_its_name(told: Told) -> None:
    pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")
    told.house.become({"hall": site("hall"), "attic": site("attic")})
    told.room("hall").figures = step(RunFigures(), running("integrator"), 40.0)
    rooms = {
        sample.labels["room"]
        for family in told.house.metrics()
        for sample in family.samples
        if "room" in sample.labels
    }
    assert "hall" in rooms
