"""One site under supervision: a real process that cannot run, and is tried anew."""

import time
from pathlib import Path
from typing import cast

import pytest

from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from tritrack.forking.zygote import Zygote
from tritrack.serving.room import AGAIN_S, Room
from tritrack.serving.served_rooms import House
from tritrack.serving.sites import Site

PATIENCE_S = 60.0


def until_told(room: Room, now_s: float) -> str:
    until_s = time.monotonic() + PATIENCE_S
    while not (told := room.look(now_s)):
        assert time.monotonic() < until_s
        time.sleep(0.05)
    return told


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

    def __init__(self, site: Site, _zygote: object) -> None:
        self.site = site

    def ask(self) -> None:
        """Nothing runs."""

    def end(self) -> None:
        """Nothing runs."""


def test_a_site_that_never_began_is_not_said_to_have_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tritrack.serving.served_rooms.Room", Stopped)
    (tmp_path / "configs").mkdir()
    said: list[str] = []
    house = House(cast(Zygote, None), said.append, said.append)
    site = Site("hall", Settings(), tmp_path / "configs" / ".." / "runs")
    house.become({"hall": site})
    house.become({})
    assert said.pop() == "hall: stopped, before it had begun a run"
    (tmp_path / "runs").mkdir()
    house.become({"hall": site})
    house.become({})
    assert said.pop() == f"hall: stopped; its run is in {tmp_path / 'runs'}"
