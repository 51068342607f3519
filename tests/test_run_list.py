"""The list of runs: what each was, its picture, its files, what can be done with it."""

import json
import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from animator.page.wish_page import encoded
from common.video.decoding import Decoder
from tritrack.starting.run_list import (
    MOST_SHOWN,
    RunFiles,
    _frame_or_paper,
    bound_of,
    files_of,
    found_runs,
    notes_of,
    picture_of,
    run_folder,
    shown_runs,
    what_of,
)


def run_in(folder: Path, at_s: float, **facts: object) -> None:
    folder.mkdir(parents=True)
    (folder / "poses.npz").write_bytes(b"")
    (folder / "summary.json").write_text(json.dumps(facts))
    os.utime(folder / "summary.json", (at_s, at_s))


def test_runs_are_listed_newest_first_and_what_is_none_is_not(tmp_path: Path) -> None:
    run_in(tmp_path / "old", 1000.0, frames=3, believed=0.5)
    run_in(tmp_path / "new", 2000.0, frames=9, believed=None)
    run_in(tmp_path / ".hidden", 3000.0)
    (tmp_path / "empty").mkdir()
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken/poses.npz").write_bytes(b"")
    (tmp_path / "broken/summary.json").write_text("{")
    run_in(tmp_path / "deep", 4000.0)
    (tmp_path / "deep/summary.json").write_text("[" * 100_000)
    shown = shown_runs(found_runs(tmp_path), {"old": 1000.0})
    assert [(run.name, run.frames, run.believed) for run in shown.runs] == [
        ("new", 9, None),
        ("old", 3, 0.5),
    ]
    assert [run.picture for run in shown.runs] == ["", "run/old/picture.jpg?1000"]


@pytest.mark.parametrize(
    "facts",
    [
        {"frames": "many", "believed": "yes", "warnings": "dark", "trust": 3, "run_of": 7},
        {"run_of": {"command": None, "footage": 3}, "settings": 3},
        {"run_of": {"footage": [None, 3]}, "settings": {"size": "huge"}},
        {"run_of": {"footage": ["a" * 5000]}},
        {"run_of": {"footage": ["a\0b"]}},
    ],
)
def test_a_summary_of_another_make_is_shown_as_far_as_it_is_understood(
    tmp_path: Path, facts: dict[str, object]
) -> None:
    run_in(tmp_path / "odd", 1000.0, **facts)
    (found,) = found_runs(tmp_path)
    (shown,) = shown_runs([found], {}).runs
    assert (shown.name, shown.frames, shown.believed, shown.notes) == ("odd", 0, None, ())
    assert bound_of(found.summary) == (320, 240)


def test_a_long_list_is_cut_and_says_so(tmp_path: Path) -> None:
    runs = [RunFiles(tmp_path, 0.0, {})] * (MOST_SHOWN + 7)
    shown = shown_runs(runs, {})
    assert (len(shown.runs), shown.left_out) == (MOST_SHOWN, 7)


@pytest.mark.parametrize(
    ("run_of", "what"),
    [
        ({"command": "single", "footage": ["/a/dance.mp4"]}, "one camera: dance.mp4"),
        (
            {"command": "track", "footage": ["/c/cam1.avi", "/c/cam2.avi"]},
            "2 cameras: cam1.avi, cam2.avi",
        ),
        ({"command": "live", "footage": ["0", "2"]}, "live: 0, 2"),
        ("nonsense", "live"),
    ],
)
def test_a_run_says_what_it_was(run_of: object, what: str) -> None:
    assert what_of({"run_of": run_of}) == what


def test_warnings_and_advice_are_shown_once() -> None:
    told = {"warnings": ["dark", "dark"], "trust": {"advice": "camera 2 was moved"}}
    assert notes_of(told) == ("dark", "camera 2 was moved")
    assert notes_of({}) == ()
    clock = {"state": "found", "applied_s": -1.25, "may_be_on_time": False, "may_be_s": []}
    assert notes_of({"clock": clock}) == (
        "view 2 is -1.25 s late: its times were set back by that",
    )
    assert notes_of({"clock": {**clock, "applied_s": 0.0, "may_be_on_time": True}}) == ()
    assert notes_of({"clock": 3, "clocks": "none"}) == ()


def test_only_results_and_exports_are_offered(tmp_path: Path) -> None:
    run_in(tmp_path / "a", 1000.0)
    for name in ("overlay.mp4", "body.bvh", "body_person12.bvh", "body_personx.bvh", "notes.txt"):
        (tmp_path / "a" / name).write_bytes(b"x")
    found = ["overlay.mp4", "body.bvh", "body_person12.bvh", "poses.npz", "summary.json"]
    assert [*files_of(tmp_path / "a")] == found
    assert files_of(tmp_path / "gone") == {}


def test_a_run_that_cannot_be_replayed_or_retouched_says_why(tmp_path: Path) -> None:
    run_in(tmp_path / "a", 1000.0, run_of={"command": "single", "footage": ["/gone.mp4"]})
    (shown,) = shown_runs(found_runs(tmp_path), {}).runs
    assert "overlay" in shown.replay
    assert shown.retouch
    video = tmp_path / "here.mp4"
    video.write_bytes(b"x")
    run_in(tmp_path / "c", 3000.0, run_of={"command": "track", "footage": [str(video)]})
    (shown, *_) = shown_runs(found_runs(tmp_path), {}).runs
    assert ("--record" in shown.replay, shown.retouch) == (True, "")
    run_in(tmp_path / "b", 4000.0, run_of={"command": "single", "footage": [str(video)]})
    (tmp_path / "b/recording.mcap").write_bytes(b"x")
    shown = shown_runs(found_runs(tmp_path), {}).runs[0]
    assert shown.replay == ""


@pytest.mark.parametrize("name", ["", ".", "..", "a/../a", "/", "a/"])
def test_a_name_leads_to_its_own_run_alone(tmp_path: Path, name: str) -> None:
    run_in(tmp_path / "a", 1000.0)
    assert run_folder(tmp_path, "a") == tmp_path / "a"
    assert run_folder(tmp_path, name) is None


@pytest.mark.slow
def test_the_picture_shows_the_body_where_the_video_shows_the_person(recorded_run: Path) -> None:
    """Of the picture's pixels that the body's strokes changed most lie on the joints' box."""
    (run,) = [each for each in found_runs(recorded_run.parent) if each.folder == recorded_run]
    with Decoder() as decoder:
        jpeg = picture_of(run, decoder)
    assert jpeg is not None
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    with np.load(recorded_run / "poses.npz") as poses:
        joints_px, frames = poses["joints_px"][:, 0, :15], poses["frame"]
    posed = np.flatnonzero(np.isfinite(joints_px).all(axis=(1, 2)))
    row = posed[len(posed) // 2]
    video = cv2.VideoCapture(str(run.summary["run_of"]["footage"][0]))
    video.set(cv2.CAP_PROP_POS_FRAMES, int(frames[row]))
    bare = video.read()[1]
    assert picture.shape == bare.shape == (120, 160, 3)
    drawn = np.argwhere(np.abs(picture.astype(int) - bare).max(axis=2) > 90)[:, ::-1]
    low, high = joints_px[row].min(axis=0) - 6, joints_px[row].max(axis=0) + 6
    assert len(drawn) > 100
    assert ((drawn >= low) & (drawn <= high)).all(axis=1).mean() > 0.95


@pytest.mark.slow
def test_a_run_without_its_video_is_drawn_on_paper(tmp_path: Path, recorded_run: Path) -> None:
    run = RunFiles(recorded_run, 0.0, {"settings": {"size": "160x120"}})
    with Decoder() as decoder:
        jpeg = picture_of(run, decoder)
    assert jpeg is not None
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape[1] >= 160
    assert np.median(picture) > 230


def test_a_run_and_videos_whose_names_are_no_unicode_are_listed(tmp_path: Path) -> None:
    """As of an archive from another system; JSON holds their bytes as half characters."""
    name = os.fsdecode(b"caf\xe9")
    run_in(tmp_path / name, 1000.0, run_of={"command": "single", "footage": [f"{name}.avi"]})
    shown = shown_runs(found_runs(tmp_path), {name: 1000.0})
    assert shown.runs[0].picture == "run/caf%E9/picture.jpg?1000"
    assert json.loads(encoded(shown))["runs"][0]["what"] == f"one camera: {name}.avi"


def test_a_folder_that_may_not_be_read_hides_no_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As lost+found, where the runs have a disk of their own."""

    def is_run(folder: Path) -> bool:
        if folder.name == "lost+found":
            raise PermissionError(13, "Permission denied")
        return True

    monkeypatch.setattr("tritrack.starting.run_list.is_run", is_run)
    for name in ("lost+found", "walk"):
        run_in(tmp_path / name, 1000.0)
    assert [run.folder.name for run in found_runs(tmp_path)] == ["walk"]


def test_a_joint_far_outside_the_picture_makes_no_huge_paper(tmp_path: Path) -> None:
    run = RunFiles(tmp_path, 0.0, {})
    joints_px = np.array([[10.0, 20.0], [1e9, 3e9]])
    with Decoder() as decoder:
        image, width_px = _frame_or_paper(run, decoder, 0, joints_px, (320, 240))
    assert image.shape == (960, 1280, 3)
    assert width_px == 1280
