"""A run fitted again with what was said: a real process over a real film (T22, T26)."""

import threading
import time
from pathlib import Path

import msgspec
import numpy as np
import psutil
import pytest
from rich.console import Console
from spoiling import film_of, write_film

from animator.retouching.fitting import FitError
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.notes.notes import Note, Notes
from common.notes.notes_file import save_notes
from tritrack.exporting import export_run
from tritrack.single.refitting import refit
from tritrack.single.single import Given, single_all

QUIET = Console(quiet=True)
SAID = Notes(note=(Note(10, orientation="backward_left"),))
pytestmark = pytest.mark.slow


@pytest.fixture
def run(clip: Path, tmp_path: Path) -> Path:
    write_film(tmp_path / "waving.avi", film_of(next(clip.glob("cam1.*")))[:30])
    single_all([tmp_path / "waving.avi"], tmp_path, Given(), Settings(size="160x120"), QUIET)
    return tmp_path / "waving"


def settings_of(film: Path) -> Settings:
    return Settings(size="160x120", camera_1=CameraSettings(source=str(film)))


def files_of(run: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in run.iterdir()}


def test_what_was_said_is_in_the_run_and_as_single_would_have_it(run: Path) -> None:
    """The same poses as `tritrack single` gives with these notes."""
    for to in ("gltf", "mot"):
        export_run(run, to, None)
    assert (run / "body.osim").exists()
    before, heard = files_of(run), list[str]()
    refit(run, settings_of(run.with_suffix(".avi")), SAID, heard.append, threading.Event())
    after = files_of(run)
    exported = {"body.glb", "body.mot", "body.osim"}
    assert after.keys() == before.keys() - exported, (
        "nothing is left over, of these poses or others"
    )
    assert any("posing, " in text for text in heard)
    notes = run.parent / "said.toml"
    save_notes(notes, SAID)
    film = [run.with_suffix(".avi")]
    single_all(film, run.parent / "other", Given(notes), Settings(size="160x120"), QUIET)
    with np.load(run / "poses.npz") as ours, np.load(run.parent / "other/waving/poses.npz") as its:
        assert set(ours["orientation"][10:]) == {"backward_left"}
        assert ours.files == its.files
        assert np.array_equal(ours["joints_m"], its["joints_m"], equal_nan=True)
    summary = msgspec.json.decode(after["summary.json"])
    assert summary["effort"]["inputs"]["orientation"] == 1
    assert summary["run_of"] == msgspec.json.decode(before["summary.json"])["run_of"]


def test_a_film_that_is_gone_leaves_the_run_as_it_was(run: Path) -> None:
    before = files_of(run)
    with pytest.raises(FitError, match=r"gone\.avi.*the run is as it was"):
        refit(run, settings_of(run.parent / "gone.avi"), SAID, str, threading.Event())
    assert files_of(run) == before


def test_a_page_that_is_closed_ends_the_fit_and_its_process(run: Path) -> None:
    before, stop = files_of(run), threading.Event()
    stop.set()
    begun_s = time.monotonic()
    with pytest.raises(FitError, match="closed"):
        refit(run, settings_of(run.with_suffix(".avi")), SAID, str, stop)
    assert time.monotonic() - begun_s < 15.0
    assert files_of(run) == before
    me = psutil.Process()
    assert not [
        one for one in me.children(recursive=True) if "spawn_main" in " ".join(one.cmdline())
    ]
