"""Runs that are stopped and go on: the same bytes as of one that was not, or a refusal."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from spoiling import changed, copied, film_of, refilmed
from typed import typed

from runtime.offline.batch import Asked, track_all
from runtime.store.past_run import CUT_SHORT, open_run
from runtime.unfinished import unfinished_run
from runtime.unfinished.resuming import MADE_OF
from tritrack.__main__ import app

PROGRAM = (
    "from runtime.unfinished import unfinished_run; unfinished_run.SAVES_S = 0.1; "
    "from tritrack.__main__ import main; main()"
)
"""The command, which saves its state more often."""
STATE = Path(unfinished_run.FOLDER, unfinished_run.STATE)
WAIT_S = 120.0


def started(*arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def stopped(run: Path, with_signal: int, *arguments: object) -> str:
    """Start a command, stop it when it has saved its state once more; what it said."""
    before = (run / STATE).stat().st_mtime_ns if (run / STATE).exists() else 0
    process, until_s = started(*arguments), time.monotonic() + WAIT_S
    while not (run / STATE).exists() or (run / STATE).stat().st_mtime_ns == before:
        assert process.poll() is None, process.communicate()[0]
        assert time.monotonic() < until_s
        time.sleep(0.02)
    os.kill(process.pid, with_signal)
    return process.communicate(timeout=WAIT_S)[0]


def ended(*arguments: object) -> str:
    """What a command says that nothing stops, here."""
    done = typed(app, *arguments)
    assert done.exit_code in (0, 3), done.output
    return " ".join(done.output.split())


@pytest.fixture(scope="module")
def long_clip(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clip under a name of its own."""
    return copied(clip, tmp_path_factory.mktemp("long") / "walk")


def poses_of(folder: Path) -> bytes:
    return (folder / "poses.npz").read_bytes()


COMMANDS: dict[str, tuple[Callable[[Path], tuple[object, ...]], int]] = {
    "one view, no calibration": (lambda clip: ("single", clip / "cam1.avi"), signal.SIGINT),
    "two views, recorded": (lambda clip: ("track", clip, "--record"), signal.SIGTERM),
}
"""And what each is stopped by, besides SIGKILL."""


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_a_run_that_was_killed_goes_on_to_the_same_bytes(
    name: str, long_clip: Path, tmp_path: Path
) -> None:
    """Killed, then stopped by Ctrl-C or by SIGTERM, each once more than the state was saved."""
    words, asked = COMMANDS[name]
    command = words(long_clip)
    run = "cam1" if command[0] == "single" else "walk"
    ended(*command, "--out", tmp_path / "whole")
    resumed = (*command, "--out", tmp_path / "parts", "--resume")
    for with_signal in (signal.SIGKILL, asked):
        said = stopped(tmp_path / "parts" / run, with_signal, *resumed)
        assert ("--resume goes on with it" in said) == (with_signal != signal.SIGKILL)
    assert "goes on after" in ended(*resumed)
    whole, parts = tmp_path / "whole" / run, tmp_path / "parts" / run
    assert poses_of(whole) == poses_of(parts)
    assert sorted(path.name for path in whole.iterdir()) == sorted(
        path.name for path in parts.iterdir()
    )
    if "--record" in command:
        assert (whole / "recording.mcap").read_bytes() == (parts / "recording.mcap").read_bytes()
    if command[0] == "single":
        assert (whole / "body.bvh").read_bytes() == (parts / "body.bvh").read_bytes()
        assert "is done already" in ended(*resumed)


@pytest.fixture(scope="module")
def cut_short(long_clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of runs in which one was killed."""
    out = tmp_path_factory.mktemp("runs")
    stopped(out / "walk", signal.SIGKILL, "track", long_clip, "--out", out)
    return out


@pytest.mark.slow
def test_what_was_done_of_a_killed_run_can_be_read(cut_short: Path) -> None:
    run = open_run(cut_short / "walk")
    assert run.summary["warnings"] == [CUT_SHORT]
    assert len(run.poses["frame"]) == run.summary["frames"] > 0


REFUSALS: dict[str, tuple[Callable[[Path, Path], object], dict[str, object], str]] = {
    "another size": (lambda clip, run: None, {"size": "80x60"}, "the settings changed"),
    "another view": (lambda clip, run: None, {"views": (1,)}, "the views"),
    "another video": (lambda clip, run: changed(clip / "cam2.avi"), {}, "cam2.avi changed"),
    "no calibration": (
        lambda clip, run: (clip / "calibration.json").unlink(),
        {},
        "calibration.json changed",
    ),
    "a damaged state": (lambda clip, run: changed(run / STATE), {}, "state.bin was damaged"),
    "a short state": (
        lambda clip, run: (run / STATE).write_bytes((run / STATE).read_bytes()[:99]),
        {},
        "state.bin was damaged",
    ),
    "no journal": (lambda clip, run: (run / "journal.bin").unlink(), {}, "cannot be read"),
    "a damaged journal": (
        lambda clip, run: (run / "journal.bin").write_bytes(
            (run / "journal.bin").read_bytes().replace(b"landmarks", b"landmerks")
        ),
        {},
        "was damaged after",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", REFUSALS)
def test_a_run_of_something_else_is_refused_in_a_line_and_left_as_it_is(
    name: str, long_clip: Path, cut_short: Path, tmp_path: Path
) -> None:
    import shutil

    from runtime.unfinished.unfinished_run import CannotResume

    harm, given, word = REFUSALS[name]
    clip = shutil.copytree(long_clip, tmp_path / "walk")
    out = shutil.copytree(cut_short, tmp_path / "runs")
    harm(clip, out / "walk")
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    said = Console(file=StringIO(), width=500)
    views, size = given.get("views"), given.get("size")
    with pytest.raises(CannotResume) as refused:
        track_all([clip], out, Asked(size=size, views=views, resume=True), said)  # type: ignore[arg-type]
    (line,) = str(refused.value).splitlines()
    assert word in line
    assert "--resume" in line
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


@pytest.mark.slow
def test_a_run_that_is_over_is_not_done_again_unless_something_changed(
    clip: Path, tmp_path: Path
) -> None:
    folder, said = copied(clip, tmp_path / "clip"), Console(file=StringIO(), width=500)
    refilmed(folder, lambda film: film[:40])

    def tracked() -> dict[str, object]:
        (facts,) = track_all([folder], tmp_path / "runs", Asked(resume=True), said)[
            "clips"
        ].values()
        return facts  # type: ignore[no-any-return]

    first = tracked()
    assert tracked()[MADE_OF] == first[MADE_OF]
    assert isinstance(said.file, StringIO)
    assert said.file.getvalue().count("is done already, of 40 frames") == 1
    refilmed(folder, lambda film: film[:39])
    assert tracked()[MADE_OF] != first[MADE_OF]
    with np.load(tmp_path / "runs" / "clip" / "poses.npz") as poses:
        assert len(poses["frame"]) == len(film_of(folder / "cam1.avi")) == 39
