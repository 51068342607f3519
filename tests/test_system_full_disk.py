"""Runs on a disk that takes no more: what was kept stays, and goes on when there is room."""

import math
from collections.abc import Callable
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from full_disk import FullDisk
from rich.console import Console

from common.bus.messages import Body
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from runtime.offline.batch import Asked, track_all
from runtime.store.past_journal import read_journal
from runtime.store.past_run import CUT_SHORT, open_run
from runtime.store.runs import RunError
from runtime.unfinished import unfinished_run
from runtime.unfinished.resuming import Wanted, resumable
from runtime.unfinished.unfinished_run import BODIES, FOLDER, STATE, UnfinishedRun
from tritrack.single.single import Given, single_all

NEVER_S, OFTEN_S = 1e9, 0.2
"""How often the state is saved."""

Run = Callable[[Path, Path, bool, Console], object]


def tracked(clip: Path, out: Path, resume: bool, console: Console) -> None:
    track_all([clip], out, Asked(resume=resume), console)


def single(clip: Path, out: Path, resume: bool, console: Console) -> None:
    single_all([clip], out, Given(resume=resume), Settings(size="160x120"), console)


RUNS = pytest.mark.parametrize("run", [tracked, single], ids=["track", "single"])


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FullDisk:
    (tmp_path / "disk").mkdir()
    return FullDisk(tmp_path / "disk", math.inf, monkeypatch)


def what_was_said(run: Run, clip: Path, disk: FullDisk) -> str:
    """Of a run that meets the full disk."""
    said = Console(file=StringIO(), width=1000)
    with pytest.raises(RunError, match=r"No space left on device; free some space or name"):
        run(clip, disk.folder, False, said)
    assert isinstance(said.file, StringIO)
    return said.file.getvalue()


@pytest.fixture(scope="module")
def whole_of(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[Run], Path]:
    """The folder of a run that never met a full disk, by what runs."""

    def made(run: Run) -> Path:
        out = tmp_path_factory.mktemp("whole")
        run(clip, out, False, Console(quiet=True))
        return out / clip.name

    return cache(made)


def resumed(run: Run, clip: Path, disk: FullDisk, whole: Path) -> str:
    """Make room and go on: the same bytes as of a run that never met it; what was said."""
    disk.room_bytes = math.inf
    said = Console(file=StringIO(), width=1000)
    run(clip, disk.folder, True, said)
    parts = disk.folder / clip.name
    assert (whole / "poses.npz").read_bytes() == (parts / "poses.npz").read_bytes()
    assert {path.name for path in whole.iterdir()} == {path.name for path in parts.iterdir()}
    assert isinstance(said.file, StringIO)
    return said.file.getvalue()


def many_bodies(wanted: Wanted, count: int) -> None:
    """A run that follows somebody through so many frames."""
    with resumable(wanted, Console(quiet=True)) as (work, _):
        bodies = work.messages(BODIES)
        for n in range(count):
            at_s = n / 15
            bodies.append(
                Body(frame=n, captured_s=at_s, clock_s=at_s, status="tracking", views="both")
            )


def test_messages_that_came_onto_the_disk_stay_there(disk: FullDisk, tmp_path: Path) -> None:
    (tmp_path / "cam1.avi").write_bytes(b"hashed, not decoded")
    settings = Settings(cameras={"cam1": CameraSettings(source=str(tmp_path / "cam1.avi"))})
    wanted = Wanted(disk.folder / "run", settings, {})
    disk.room_bytes = 50_000
    with pytest.raises(RunError):
        many_bodies(wanted, 10_000)
    left = read_journal(disk.folder / "run")
    assert left is not None
    frames = [body.frame for body in left.bodies]
    assert frames == [*range(len(frames))]
    assert len(frames) > 100
    assert disk.used_bytes == 50_000


@pytest.mark.slow
@RUNS
def test_what_was_tracked_stays_where_no_state_was_saved_yet(
    run: Run,
    clip: Path,
    whole_of: Callable[[Run], Path],
    disk: FullDisk,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever came whole onto the disk can be read, as of a run that was cut short."""
    whole = whole_of(run)
    monkeypatch.setattr(unfinished_run, "SAVES_S", NEVER_S)
    monkeypatch.setattr("runtime.unfinished.message_file.AT_ONCE", 4096)
    disk.room_bytes = 60_000
    said = what_was_said(run, clip, disk)
    assert f"{clip.name}: what is done is kept, but its state did not fit: --resume" in said
    assert disk.used_bytes == pytest.approx(60_000, abs=100)
    if run is tracked:  # the other is not yet at poses
        left = open_run(disk.folder / clip.name)
        assert left.summary["warnings"] == [CUT_SHORT]
        assert 20 < len(left.poses["frame"]) == left.summary["frames"] < 69
        assert np.isfinite(left.poses["joints_m"]).all(axis=(1, 2)).sum() > 10
    assert "goes on after" not in resumed(run, clip, disk, whole)


@pytest.mark.slow
@RUNS
def test_a_run_goes_on_from_the_state_that_was_saved_before(
    run: Run,
    clip: Path,
    whole_of: Callable[[Run], Path],
    disk: FullDisk,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What does not fit beside it is lost alone: the next state, or messages."""
    whole = whole_of(run)
    monkeypatch.setattr(unfinished_run, "SAVES_S", OFTEN_S)
    save = UnfinishedRun.save

    def filling(own: UnfinishedRun, stage: str, state: Any) -> None:
        save(own, stage, state)
        disk.room_bytes = disk.used_bytes + 30_000

    monkeypatch.setattr(UnfinishedRun, "save", filling)
    said = what_was_said(run, clip, disk)
    assert "what is done is kept: --resume goes on with it" in said
    assert (disk.folder / clip.name / FOLDER / STATE).is_file()
    monkeypatch.setattr(UnfinishedRun, "save", save)
    assert "goes on after" in resumed(run, clip, disk, whole)
