"""The retouching command over a real page: its run, its video and its notes, found or refused."""

import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from rich.console import Console
from test_exporting import write

from animator.retouching.fitting import FitError
from common.body.body import JOINT_NAMES
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.notes.notes import Note, Notes
from common.notes.notes_file import load_notes, save_notes
from common.rig.camera import PAPER_ROTATIONS
from common.video.clips import open_clip
from runtime.store.past_run import open_run
from tritrack.single import retouching
from tritrack.single.retouching import RetouchError, how_to_go_on, retouch

QUIET = Console(quiet=True)


def film(path: Path, count: int = 4) -> None:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 15.0, (320, 240))
    for i in range(count):
        writer.write(np.full((240, 320, 3), 60 * i, np.uint8))
    writer.release()


def run_of(folder: Path, video: Path, n: int = 4, frames: Sequence[int] = ()) -> Path:
    """A run of n frames in which nobody was found."""
    arrays = {
        "frame": np.array(frames or range(n), np.int64),
        "time_s": np.arange(n) / 15,
        "joints_m": np.full((n, 15, 3), np.nan),
        "joints_px": np.full((n, 2, 15, 2), np.nan),
        "angles_deg": np.full((n, 17), np.nan),
        "confidence": np.zeros((n, 15)),
        "status": np.full(n, "empty"),
        "views": np.full(n, "none"),
        "score": np.zeros((n, 2)),
        "joint_names": np.array(JOINT_NAMES),
    }
    write(folder, arrays, json.dumps({"settings": {"cameras": {"cam1": {"source": str(video)}}}}))
    return folder


@pytest.mark.slow
def test_the_page_opens_and_ctrl_c_ends_it_with_the_ledger(tmp_path: Path) -> None:
    """A whole process: the page answers, SIGINT is the way out and no failure (exit 0)."""
    pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")
    film(tmp_path / "dance.avi")
    save_notes(tmp_path / "notes.toml", Notes("dance.avi", (Note(1, "left"),)))
    run = run_of(tmp_path / "run", tmp_path / "dance.avi")
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        port = trial.getsockname()[1]
    command = [sys.executable, "-m", "tritrack", "retouch", str(run), "--port", str(port), "--json"]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        told = next(process.stderr)
        assert told.startswith("the page is at"), "no log of a library comes before it"
        address = re.search(r"http://\S+\d", told)
        assert address is not None
        with urllib.request.urlopen(address[0]) as answer:
            assert answer.status == 200
        process.send_signal(signal.SIGINT)
        facts = json.loads(process.stdout.read())
        assert process.wait(20) == 0
    assert facts["notes"] == str(tmp_path / "notes.toml")
    assert facts["inputs"] == {"orientation": 1, "depth": 0, "joints": 0, "all": 1}
    assert facts["thesis"]["dancing"] == {"frames": 200, "by_hand": 506, "all": 59}


def test_a_video_that_has_moved_is_named_with_the_cure(tmp_path: Path) -> None:
    run = run_of(tmp_path / "run", tmp_path / "gone.avi")
    with pytest.raises(RetouchError, match=r"gone\.avi.*--video"):
        retouch(run, None, None, 8080, QUIET)


def test_settings_that_no_run_has_are_named(tmp_path: Path) -> None:
    run = run_of(tmp_path / "run", tmp_path / "gone.avi")
    (run / "summary.json").write_text('{"settings": {"mode": "sideways"}}')
    with pytest.raises(RetouchError, match=r"summary\.json.*sideways.*track the clip again"):
        retouch(run, None, None, 8080, QUIET)


def test_a_camera_that_no_run_assumes_is_named(tmp_path: Path) -> None:
    film(tmp_path / "dance.avi")
    run = run_of(tmp_path / "run", tmp_path / "dance.avi")
    told = json.loads((run / "summary.json").read_text())
    (run / "summary.json").write_text(json.dumps(told | {"camera": {"name": "cam1", "R": 3}}))
    with pytest.raises(RetouchError, match=r"has no camera as it was written.*again"):
        retouch(run, None, None, 8080, QUIET)


def test_a_run_without_frames_is_refused(tmp_path: Path) -> None:
    film(tmp_path / "dance.avi")
    run = run_of(tmp_path / "run", tmp_path / "dance.avi", 0)
    with pytest.raises(RetouchError, match="no frame"):
        retouch(run, None, None, 8080, QUIET)


def test_what_to_do_with_the_notes_names_the_video_and_what_they_are_of(tmp_path: Path) -> None:
    run = open_run(run_of(tmp_path / "run", tmp_path / "gone.avi"))
    video = Path("my dance.avi")
    assert how_to_go_on(video, run).endswith("these notes: tritrack single 'my dance.avi'")
    run.poses["seen"] = np.ones((4, 2), np.bool_)
    said = how_to_go_on(video, run)
    assert "other cameras too" in said
    assert said.endswith("tritrack single 'my dance.avi'")


class Page:
    """What a browser would be shown; the notes that are said on it are `SAID`."""

    address = "http://127.0.0.1:1/"
    SAID = Notes("dance.avi", (Note(1, "left"),))

    def __init__(self, take, size, picture_of, notes, save, fit, port) -> None:  # type: ignore[no-untyped-def]
        self.take, self.size, self.picture_of = take, size, picture_of
        self.begun, self.save, self.fit, self.port = notes, save, fit, port
        self.notes, self.fitted, self.closed = notes, None, False

    def told(self) -> "Page":
        self.notes = self.SAID
        self.kept = self.save(self.SAID)
        return self

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def pages(monkeypatch: pytest.MonkeyPatch) -> list[Page]:
    """The pages that were shown; something is said on each, then comes Ctrl-C."""
    pytest.importorskip("viser", reason="the page is an extra: install tritrack[page]")
    shown: list[Page] = []

    def show(*of: Any) -> Page:
        shown.append(Page(*of))
        return shown[-1]

    monkeypatch.setattr("animator.retouching.retouch.RetouchPage", show)
    over = SimpleNamespace(wait=lambda: shown.append(shown.pop().told()))
    monkeypatch.setattr(retouching, "process", lambda *_: nullcontext(over))
    return shown


def test_every_row_has_its_own_picture_and_what_is_said_is_kept_beside_the_video(
    pages: list[Page], tmp_path: Path
) -> None:
    """Frames of 0, 60, 120 and 180 grey; the run begins with the second and skips the third."""
    film(tmp_path / "dance.avi")
    run = run_of(tmp_path / "run", tmp_path / "dance.avi", 2, (1, 3))
    console = Console(record=True, width=200, file=io.StringIO())
    facts = retouch(run, None, None, 4321, console)
    (page,) = pages
    assert (page.size, page.port, page.closed) == ((320, 240), 4321, True)
    assert [float(page.picture_of(row).mean()) for row in (0, 1)] == pytest.approx([60, 180], abs=3)
    assert page.begun == Notes("dance.avi")
    notes = tmp_path / "notes.toml"
    assert load_notes(notes) == Page.SAID
    assert page.kept == ("1 input, kept in notes.toml", True)
    assert facts["notes"] == str(notes)
    assert facts["inputs"]["orientation"] == 1
    said = console.export_text()
    assert "the page is at http://127.0.0.1:1/" in said
    assert "then fit the video again with these notes: tritrack single" in said
    with pytest.raises(FitError, match="tritrack single"):
        page.fit(Page.SAID, lambda _: None)


def test_notes_named_are_gone_on_with_and_what_cannot_be_kept_is_said(
    pages: list[Page], tmp_path: Path
) -> None:
    film(tmp_path / "moved.avi")
    run = run_of(tmp_path / "run", tmp_path / "gone.avi")
    named, before = tmp_path / "mine.toml", Notes("dance.avi", (Note(0, "right"),))
    save_notes(named, before)
    retouch(run, tmp_path / "moved.avi", named, 1, QUIET)
    assert pages[-1].begun == before
    assert load_notes(named) == Page.SAID
    (tmp_path / "file").write_text("")
    retouch(run, tmp_path / "moved.avi", tmp_path / "file" / "notes.toml", 1, QUIET)
    told, well = pages[-1].kept
    assert not well
    assert "file/notes.toml" in told


def test_a_run_of_a_camera_wants_a_film_of_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    film(tmp_path / "dance.avi")
    run = run_of(tmp_path / "run", tmp_path / "dance.avi")
    settings = Settings(cameras={"cam1": CameraSettings(source=str(tmp_path / "dance.avi"))})
    found = open_clip(settings, None, (1,))
    camera = msgspec.structs.replace(found.views[0], source=0)
    live = msgspec.structs.replace(found, views=(camera,))
    monkeypatch.setattr(retouching, "open_clip", lambda *_: live)
    with pytest.raises(RetouchError, match="is of a camera: name a video of it with --video"):
        retouch(run, None, None, 8080, QUIET)


def settings_of(tmp_path: Path, settings: dict[str, Any], video: Path | None) -> Settings:
    run = run_of(tmp_path / "run", tmp_path / "gone.avi")
    (run / "summary.json").write_text(json.dumps({"settings": settings}))
    return retouching._settings_of(open_run(run), video)


def test_the_video_that_is_named_takes_the_place_of_what_the_run_was_of(tmp_path: Path) -> None:
    """The rest of its camera stays, a device of this host does not; a clip is not read any more."""
    camera = {"device": 2, "calibrated_as": "left", "background": "room.png"}
    told = {"size": "80x60", "cameras": {"cam1": camera}}
    found = settings_of(tmp_path, told, Path("moved.avi"))
    assert found.cameras["cam1"] == CameraSettings("moved.avi", -1, "room.png", "left")
    assert (found.size, found.clip) == ("80x60", "")
    found = settings_of(tmp_path, {"clip": "some/clip"}, Path("moved.avi"))
    assert (found.cameras["cam1"], found.clip) == (CameraSettings("moved.avi"), "")
    found = settings_of(tmp_path, {"clip": "some/clip"}, None)
    assert (found.cameras, found.clip) == ({}, "some/clip")


def test_the_turn_to_the_camera_is_the_calibrations_the_assumed_one_or_level(
    tmp_path: Path,
) -> None:
    film(tmp_path / "dance.avi")
    run = run_of(tmp_path / "run", tmp_path / "dance.avi")
    filmed = CameraSettings(str(tmp_path / "dance.avi"))
    clip = open_clip(Settings(cameras={"cam1": filmed}), None, (1,))
    level = retouching._turn_of(open_run(run), msgspec.structs.replace(clip, rig=None))
    assert level == PAPER_ROTATIONS[0]
    turn = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]
    K = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]
    camera = {"name": "cam1", "K": K, "R": turn, "t": [0, 0, 4.0]}
    (run / "summary.json").write_text(json.dumps({"camera": camera}))
    assumed = retouching._turn_of(open_run(run), msgspec.structs.replace(clip, rig=None))
    assert [list(row) for row in assumed] == turn
    cameras = (SimpleNamespace(R="calibrated"), SimpleNamespace(R="other"))
    rig: Any = SimpleNamespace(cameras=cameras)
    calibrated: Any = retouching._turn_of(open_run(run), SimpleNamespace(rig=rig))  # type: ignore[arg-type]
    assert calibrated == "calibrated"


def test_a_row_without_a_picture_shows_the_one_before_it_or_black(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The video has frames 0 to 3 of 0, 60, 120 and 180 grey; rows beyond it keep the last."""
    film(tmp_path / "dance.avi")
    camera = CameraSettings(str(tmp_path / "dance.avi"))
    clip = open_clip(Settings(cameras={"cam1": camera}), None, (1,))

    def shown(*frames: int) -> list[float]:
        take: Any = SimpleNamespace(frame=np.array(frames))
        pictures = retouching._pictures(clip, take, QUIET)
        return [float(retouching._decoded(jpeg).mean()) for jpeg in pictures]

    assert shown(1, 3, 7, 9) == pytest.approx([60, 180, 180, 180], abs=3)
    assert shown(8, 2) == pytest.approx([0, 120], abs=3)
    monkeypatch.setattr(retouching, "MOST_PICTURES", 2)
    assert len(shown(0, 1)) == 2
    with pytest.raises(RetouchError, match=r"^3 frames are too many .* of at most 2 frames each$"):
        shown(0, 1, 2)


def test_only_a_run_of_a_video_by_single_is_fitted_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    run = open_run(run_of(tmp_path / "run", tmp_path / "gone.avi"))
    for told, fitted in (
        (None, False),
        (SimpleNamespace(command="track", footage=["a.mp4"]), False),
        (SimpleNamespace(command="single", footage=["a.mp4"]), True),
        (SimpleNamespace(command="single", footage=["a.mp4", "masks.npz"]), False),
    ):
        monkeypatch.setattr(retouching, "run_told", lambda _, told=told: told)
        assert retouching.fitted_by_single(run) is fitted
