"""Clip after clip: what is said of each, and how a bar hears how far one is."""

from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from spoiling import copied, refilmed

from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from tritrack.commands.clip_commands import line_of_runs
from tritrack.offline.batch import Asked, track_all
from tritrack.offline.lockstep import Decoders, track_clip
from tritrack.unfinished.work import Course

VIEWS: tuple[tuple[ViewerNumber, ...], ...] = ((1, 2), (1,))


@pytest.mark.parametrize("views", VIEWS)
def test_a_clip_that_shows_nobody_is_tracked_and_that_is_said(
    clip: Path, tmp_path: Path, views: tuple[ViewerNumber, ...]
) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: 4 * film[:8])
    said = Console(file=StringIO(), width=500)
    track_all([folder], tmp_path / "runs", Asked(views=views), said)
    assert isinstance(said.file, StringIO)
    assert "warning: clip: nobody was seen" in said.file.getvalue()


@pytest.mark.parametrize("views", VIEWS)
@pytest.mark.parametrize("calibrated", [True, False])
def test_a_bar_hears_of_every_frame_of_a_clip(
    clip: Path, tmp_path: Path, views: tuple[ViewerNumber, ...], calibrated: bool
) -> None:
    folder, shares = copied(clip, tmp_path / "clip"), list[float]()
    if not calibrated:
        (folder / "calibration.json").unlink()
    with Decoders() as decoders:
        done = track_clip(Settings(clip=str(folder)), decoders, views, course=Course(shares.append))
    assert shares == sorted(shares)
    assert (len(shares), shares[-1]) == (len(done.bodies), 1.0)


ADVICE = "the cameras are exchanged: change their order"


@pytest.mark.parametrize("advice", ["", ADVICE])
def test_a_calibration_that_is_not_believable_is_in_the_last_line_too(advice: str) -> None:
    clips: dict[str, dict[str, Any]] = {
        "walk": {"believed": 1.0, "trust": {"advice": advice}},
        "run": {"believed": 1.0},
    }
    line = line_of_runs(clips, Path("runs"))
    assert line.startswith("2 clips tracked, written to runs; believed in 100%")
    assert ("not believable: the calibration of walk" in line) == bool(advice)


def test_one_clip_is_one_clip() -> None:
    assert line_of_runs({"walk": {"believed": None}}, Path("r")) == "1 clip tracked, written to r"
