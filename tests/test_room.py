"""One site under supervision: a real process that cannot run, and is tried anew."""

import time
from pathlib import Path

from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from tritrack.serving.room import AGAIN_S, Room
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
