"""One site under supervision: a real process that cannot run, and is tried anew."""

import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from common.bus.control_messages import Pulse
from common.bus.message_codec import encode
from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from common.platform.platform import Launcher
from runtime.live.supervise import PartFailed
from runtime.serving.room import AGAIN_S, SITE, Room, site_main
from runtime.serving.served_rooms import House
from runtime.serving.sites import Site

PATIENCE_S = 60.0


def until_told(room: Room, now_s: float) -> str:
    until_s = time.monotonic() + PATIENCE_S
    while not (told := room.look(now_s)):
        assert time.monotonic() < until_s
        time.sleep(0.05)
    return told


@pytest.mark.slow
def test_a_site_that_cannot_run_says_why_and_is_tried_anew(tmp_path: Path) -> None:
    settings = Settings(
        clip=str(tmp_path / "nowhere"), page=PageSettings(port=0), bus=BusSettings(endpoint="auto")
    )
    room = Room(Site("hall", settings, tmp_path / "runs"))
    try:
        told = until_told(room, 100.0)
        assert told.startswith("hall: down: ")
        assert "nowhere" in told
        assert told == room.status.line
        assert room.look(100.0 + AGAIN_S - 1.0) == ""
        assert room.failure
        room.look(100.0 + AGAIN_S)
        assert not room.failure
        assert until_told(room, 200.0) == told
    finally:
        room.end()


class Stopped:
    """A room without a process."""

    pulse = None

    def __init__(self, site: Site, _launcher: object) -> None:
        self.site = site

    def ask(self) -> None:
        """Nothing runs."""

    def end(self) -> None:
        """Nothing runs."""


def test_a_site_that_never_began_is_not_said_to_have_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("runtime.serving.served_rooms.Room", Stopped)
    (tmp_path / "configs").mkdir()
    said: list[str] = []
    house = House(cast(Launcher, None), said.append, said.append)
    site = Site("hall", Settings(), tmp_path / "configs" / ".." / "runs")
    house.become({"hall": site})
    house.become({})
    assert said.pop() == "hall: stopped, before it had begun a run"
    (tmp_path / "runs").mkdir()
    house.become({"hall": site})
    house.become({})
    assert said.pop() == f"hall: stopped; its run is in {tmp_path / 'runs'}"


class Part:
    """What stands for the process of a site: it is looked at, and says what it is told to."""

    def __init__(self, part: Any) -> None:
        self.part, self.given_up, self.news = part, "", ""
        self.calls = list[Any]()
        self.alive = True
        self.running = SimpleNamespace(process=SimpleNamespace(is_alive=lambda: self.alive))

    def look(self, now_s: float, pulses: Any) -> str:
        self.calls.append((now_s, {**pulses}))
        if self.news == "fails":
            raise PartFailed("hall: no camera 0")
        return self.news

    def ask(self) -> None:
        self.calls.append("ask")

    def end(self) -> None:
        self.calls.append("end")


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> list[Part]:
    begun: list[Part] = []

    def watched(part: Any) -> Part:
        begun.append(Part(part))
        return begun[-1]

    monkeypatch.setattr("runtime.serving.room.Watched", watched)
    return begun


def test_a_site_is_a_part_that_nests_and_its_pulses_are_its_own_until_it_is_begun_anew(
    parts: list[Part],
) -> None:
    site = Site("hall", Settings(bus=BusSettings(endpoint="auto")), Path("runs"))
    launcher: Any = object()
    room = Room(site, launcher)
    part = parts[0].part
    own, words = part.arguments
    assert (part.name, part.main, part.end_s) == ("hall", site_main, 20.0)
    assert (part.beats, part.nests, part.leads, part.launcher) == (True, True, False, launcher)
    assert own.settings.bus.endpoint.startswith("tcp/127.0.0.1:"), "chosen"
    assert (own.name, own.out, room.site) == ("hall", Path("runs"), site)
    words.send_bytes(encode(Pulse(process="hall", state="ready", frames=3)))
    words.send_bytes(encode(Pulse(process="hall", state="running", frames=5)))
    assert room.pulse is None
    assert room.look(10.0) == ""
    ((now_s, pulses),) = parts[0].calls
    assert (now_s, pulses["hall"].frames) == (10.0, 5)
    assert room.pulse is not None
    assert (room.pulse.process, room.pulse.frames, room.status.well) == ("hall", 5, True)
    figures = room.figures.parts[SITE]
    assert figures.pulse is not None
    assert (figures.pulse.frames, figures.heard_s, figures.there) == (5, 10.0, True)
    parts[0].alive, parts[0].news = False, "hall: it is started again in 0.5 s"
    assert room.look(11.0) == "hall: it is started again in 0.5 s"
    assert not room.figures.parts[SITE].there

    parts[0].news = "fails"
    told = room.look(100.0)
    assert told == (
        "hall: down: no camera 0; tried anew every 60 s, or at once when its settings change"
    )
    assert (room.status.well, room.figures.parts[SITE].there) == (False, False)
    assert (room.look(159.9), len(parts)) == ("", 1)
    assert (room.look(160.0), len(parts), room.failure) == ("", 2, "")
    assert room.pulse is None, "not that of the one before"
    parts[1].given_up, parts[1].news = "given up", "hall: killed; given up"
    assert room.look(161.0).startswith("hall: down: killed; given up; tried anew every 60 s")
    room.ask()
    room.end()
    assert parts[1].calls[-2:] == ["ask", "end"]
    with pytest.raises(OSError, match="closed"):
        words.send_bytes(b"")
