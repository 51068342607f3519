"""Every instant of a clip: whatever the mode, its state is kept and goes on to the same bodies."""

from pathlib import Path
from typing import Any

import pytest
from spoiling import copied, refilmed

from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.method import Mode
from tritrack.offline.lockstep import Decoders, track_clip
from tritrack.unfinished.state_codec import packed, unpacked
from tritrack.unfinished.work import Course, Kept

STOP_AT = 30


class Stopped(Exception):
    """The run was cut short."""


class Stopping:
    """Keeps each state as bytes; the first run is cut short, the second goes on from the last."""

    due = True

    def __init__(self) -> None:
        self.saved: tuple[str, bytes, dict[str, int]] | None = None
        self.kept: dict[str, list[Any]] = {}
        self.saves, self.stops = 0, True

    def messages(self, name: str) -> Kept:
        length = self.saved[2].get(name, 0) if self.saved else 0
        self.kept[name] = self.kept.get(name, [])[:length]
        return self.kept[name]

    def resumed(self, stage: str, kind: type[Any]) -> Any:
        return unpacked(self.saved[1], kind) if self.saved and self.saved[0] == stage else None

    def save(self, stage: str, state: object) -> None:
        lengths = {name: len(messages) for name, messages in self.kept.items()}
        self.saved, self.saves = (stage, packed(state), lengths), self.saves + 1
        if self.stops and self.saves % STOP_AT == 0:
            raise Stopped


WAYS: list[tuple[Mode, tuple[ViewerNumber, ...], bool]] = [
    ("default", (1, 2), True),
    ("default", (1, 2), False),
    ("default", (2,), True),
    ("default", (1,), False),
    ("paper", (1, 2), True),
    ("paper", (1,), True),
    ("thesis", (1,), False),
]


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "views", "calibrated"), WAYS)
def test_a_run_that_stops_every_thirty_instants_gives_the_same_bodies(
    mode: Mode, views: tuple[ViewerNumber, ...], calibrated: bool, clip: Path, tmp_path: Path
) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[:70])
    if not calibrated:
        (folder / "calibration.json").unlink()
    settings, work = Settings(clip=str(folder), mode=mode), Stopping()
    with Decoders() as decoders:
        whole = track_clip(settings, decoders, views)
        while True:
            try:
                parts = track_clip(settings, decoders, views, course=Course(work=work))
                break
            except Stopped:
                continue
    assert work.saves > STOP_AT
    assert list(parts.bodies) == list(whole.bodies)
    for facts in (parts.facts, whole.facts):
        for measured in ("seconds", "frames_a_second"):
            facts.pop(measured)
    assert parts.facts == whole.facts
