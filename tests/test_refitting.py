"""A run fitted again with what was said: a real process over a real film (T22, T26)."""

import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import psutil
import pytest
from rich.console import Console
from spoiling import film_of, write_video

from animator.retouching.fitting import FitError
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.notes.notes import Note, Notes
from common.notes.notes_file import save_notes
from runtime.store.run_exports import Format
from runtime.store.runs import RunError
from tritrack.exporting import ExportError, export_run
from tritrack.single import refitting
from tritrack.single.refitting import Said, refit
from tritrack.single.single import Given, single_all

QUIET = Console(quiet=True)
SAID = Notes(note=(Note(10, orientation="backward_left"),))


@pytest.fixture
def run(clip: Path, tmp_path: Path) -> Path:
    write_video(tmp_path / "waving.avi", film_of(next(clip.glob("cam1.*")))[:30])
    single_all([tmp_path / "waving.avi"], tmp_path, Given(), Settings(size="160x120"), QUIET)
    return tmp_path / "waving"


def settings_of(film: Path) -> Settings:
    return Settings(size="160x120", cameras={"cam1": CameraSettings(source=str(film))})


def files_of(run: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in run.iterdir()}


@pytest.mark.slow
def test_what_was_said_is_in_the_run_and_as_single_would_have_it(run: Path) -> None:
    """The same poses as `tritrack single` gives with these notes."""
    formats: tuple[Format, ...] = ("gltf", "mot")
    for to in formats:
        export_run(run, to, None)
    assert (run / "body.osim").exists()
    before, heard = files_of(run), list[str]()
    refit(run, settings_of(run.with_suffix(".avi")), SAID, heard.append, threading.Event())
    after = files_of(run)
    assert after.keys() == before.keys()
    exported = ("body.glb", "body.mot", "body.osim")
    own = {name: (run / name).read_bytes() for name in exported}
    for to in formats:
        export_run(run, to, None)
    assert own == {name: (run / name).read_bytes() for name in exported}, "of the new poses"
    assert own["body.glb"] != before["body.glb"]
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


@pytest.mark.slow
def test_a_film_that_is_gone_leaves_the_run_as_it_was(run: Path) -> None:
    before = files_of(run)
    with pytest.raises(FitError, match=r"gone\.avi.*the run is as it was"):
        refit(run, settings_of(run.parent / "gone.avi"), SAID, str, threading.Event())
    assert files_of(run) == before


@pytest.mark.slow
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


class Pipe:
    """One end of a pipe, from which words come after so many silences."""

    def __init__(self, *words: Any, silences: int = 0) -> None:
        self.words, self.silences, self.sent = list(words), silences, list[Said]()
        self.closed = False

    def poll(self, seconds: float) -> bool:
        assert seconds == 0.2
        self.silences -= 1
        return self.silences < 0

    def recv(self) -> Any:
        word = self.words.pop(0)
        if isinstance(word, Exception):
            raise word
        return word

    def send(self, said: Said) -> None:
        self.sent.append(said)

    def close(self) -> None:
        self.closed = True


def test_what_is_heard_is_waited_for_unless_the_page_is_closed_or_the_process_died() -> None:
    stop = threading.Event()
    words: Any = Pipe(Said("far", "half"), silences=3)
    assert refitting._next(words, stop) == Said("far", "half")
    dead: Any = Pipe(EOFError())
    assert refitting._next(dead, stop) == Said(
        "failed", "what fitted the video was killed, the run is as it was: fit again"
    )
    stop.set()
    closed: Any = Pipe(Said("done"), silences=1)
    assert refitting._next(closed, stop) == Said(
        "failed", "the page was closed: the run is as it was"
    )
    spoken: Any = Pipe(Said("done"))
    assert refitting._next(spoken, stop) == Said("done"), "what was said first counts"


class Child:
    """A process that ends when it is told to, or only when it is killed."""

    def __init__(self, stubborn: bool = False) -> None:
        self.stubborn, self.exitcode, self.done = stubborn, None, list[Any]()

    def start(self) -> None:
        self.done.append("start")

    def terminate(self) -> None:
        self.done.append("terminate")
        self.exitcode = None if self.stubborn else -15  # type: ignore[assignment]

    def kill(self) -> None:
        self.done.append("kill")

    def join(self, seconds: float | None = None) -> None:
        self.done.append(seconds)


def test_a_process_that_does_not_end_in_five_seconds_is_killed() -> None:
    quick: Any = Child()
    stubborn: Any = Child(stubborn=True)
    refitting._end(quick)
    refitting._end(stubborn)
    assert quick.done == ["terminate", 5.0]
    assert stubborn.done == ["terminate", 5.0, "kill", None]


def apart(monkeypatch: pytest.MonkeyPatch, *words: Said) -> tuple[list[str], Child, Pipe, Any]:
    """Fit apart in a process that says these words."""
    ours, theirs, child, started = Pipe(*words), Pipe(), Child(), list[Any]()

    def process(target: Any, args: Any) -> Child:
        started.append((target, args))
        return child

    spawn = SimpleNamespace(Pipe=lambda duplex: (ours, theirs), Process=process)
    monkeypatch.setattr(refitting, "SPAWN", spawn)
    told: list[str] = []
    new, settings = Path("new"), Settings()
    try:
        refitting._fitted_apart(new, settings, SAID, told.append, threading.Event())
    finally:
        assert started == [(refitting._fit, (new, settings, SAID, theirs))]
        assert theirs.closed
        assert ours.closed
        assert child.done == ["start", "terminate", 5.0]
    return told, child, ours, started


def test_all_that_is_said_is_passed_on_until_it_is_done_or_failed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    words = (Said("far", "one"), Said("far", "two"), Said("done", "fitted"))
    told, *_ = apart(monkeypatch, *words)
    assert told == ["one", "two", "fitted"]
    with pytest.raises(FitError, match="no room"):
        apart(monkeypatch, Said("far", "one"), Said("failed", "no room"))


def test_the_process_says_each_twentieth_of_its_four_steps_and_how_it_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    jobs: list[Any] = []

    def following(job: Any, folder: Path, decoder: Any, console: Any, begun: Any, run: Any) -> None:
        jobs.append((job, folder, console.quiet))
        tell = begun("cutting out")
        for share in (0.0, 0.04, 0.06, 0.1, 0.12, 1.0):
            tell(share)
        begun("drawing")(0.5)

    said: Any = Pipe()
    monkeypatch.setattr(refitting, "follow", following)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    settings = settings_of(Path("a.avi"))
    refitting._fit(Path("out"), settings, SAID, said)
    ((job, folder, quiet),) = jobs
    assert (job.path, job.settings, job.masks, job.notes) == (Path("a.avi"), settings, None, SAID)
    assert (folder, quiet) == (Path("out"), True)
    assert said.sent == [
        Said("far", "fitting again, step 2 of 4: cutting out, 0%"),
        Said("far", "fitting again, step 2 of 4: cutting out, 6%"),
        Said("far", "fitting again, step 2 of 4: cutting out, 12%"),
        Said("far", "fitting again, step 2 of 4: cutting out, 100%"),
        Said("far", "fitting again, step 4 of 4: drawing, 50%"),
        Said("done", "fitted"),
    ]

    def failing(*_: Any) -> None:
        raise RunError("no room")

    monkeypatch.setattr(refitting, "follow", failing)
    said.sent.clear()
    refitting._fit(Path("out"), settings, SAID, said)
    assert said.sent == [Said("failed", "no room; the run is as it was")]


def test_new_files_take_the_place_of_old_ones_and_exports_of_the_old_fit_are_made_anew(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The notes of the user, say, are no file of the fit: they stay."""
    old = ("poses.npz", "body.bvh", "keyframes.bvh", "body.glb", "markers.trc", "notes.toml")
    for name in old:
        (tmp_path / name).write_text("old")

    def fitted(new: Path, settings: Any, notes: Notes, tell: Any, stop: Any) -> None:
        assert new.parent.parent == tmp_path
        new.mkdir()
        for name in ("poses.npz", "body.bvh"):
            (new / name).write_text("new")

    def exported(folder: Path, to: str, out: None) -> None:
        if to == "trc":
            raise ExportError("no room")
        assert (folder / "poses.npz").read_text() == "new"
        (folder / "body.glb").write_text(f"new {to}")

    monkeypatch.setattr(refitting, "_fitted_apart", fitted)
    monkeypatch.setattr(refitting, "export_run", exported)
    told: list[str] = []
    refit(tmp_path, Settings(), SAID, told.append, threading.Event())
    assert told == ["markers.trc was not made anew: no room"]
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "poses.npz": "new",
        "body.bvh": "new",
        "body.glb": "new gltf",
        "notes.toml": "old",
    }
    gone = tmp_path / "gone"
    with pytest.raises(FitError, match=r"^cannot write .*gone.*: No such file or directory; see"):
        refit(gone, Settings(), SAID, str, threading.Event())
