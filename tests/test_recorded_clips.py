"""The page's recordings: what stands in their list, and that their frames keep their times."""

from pathlib import Path

import pytest

from common.video.camera_file import write_times
from tritrack.recording_cameras.recorded_clips import (
    finish_recording,
    recorded_times,
    recorded_videos,
    recording_names,
    remove_recording,
    shown_recordings,
)


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """A recording of two cameras, and one that was never finished."""
    for name in ("walk", "torn"):
        folder = tmp_path / ".recorded" / name
        folder.mkdir(parents=True)
        for camera in ("cam2", "cam1"):
            (folder / f"{camera}.avi").write_bytes(b"RIFF")
    write_times(tmp_path / ".recorded/walk", {"cam1": [5.0, 5.5, 6.5], "cam2": [5.25, 5.75, 6.25]})
    return tmp_path


def test_a_recording_is_listed_once_it_is_whole(runs: Path) -> None:
    assert recording_names(runs) == ["walk"]
    (shown,) = shown_recordings(runs).recordings
    assert (shown.name, shown.says) == ("walk", "2 cameras, 1.5 s")
    videos = recorded_videos(runs, "walk")
    assert [path.name for path in videos] == ["cam1.avi", "cam2.avi"]
    assert recorded_times(videos[1]) == (0.25, 0.75, 1.25)


@pytest.mark.parametrize("name", ["torn", "none", "..", "../walk", "."])
def test_what_is_not_listed_is_neither_taken_nor_deleted(runs: Path, name: str) -> None:
    assert recorded_videos(runs, name) == []
    assert not remove_recording(runs, name)
    assert (runs / ".recorded/torn/cam1.avi").is_file()


def test_a_link_is_no_recording(runs: Path, tmp_path: Path) -> None:
    (runs / ".recorded/linked").symlink_to(runs / ".recorded/walk")
    assert recording_names(runs) == ["walk"]


def test_a_recording_is_deleted_whole(runs: Path) -> None:
    assert remove_recording(runs, "walk")
    assert [path.name for path in (runs / ".recorded").iterdir()] == ["torn"]


@pytest.mark.parametrize("meta", [None, "no JSON", "{}"])
def test_a_video_whose_times_are_not_known_has_none(runs: Path, meta: str | None) -> None:
    video = runs / ".recorded/torn/cam1.avi"
    if meta is not None:
        (video.parent / "meta.json").write_text(meta)
    assert recorded_times(video) == ()


def test_a_recording_that_was_killed_is_one_if_two_cameras_left_times(runs: Path) -> None:
    torn = runs / ".recorded/torn"
    (torn / "cam1.times.txt").write_text("5.00000\n5.50000\n6.00000\n")
    finish_recording(torn)
    assert recording_names(runs) == ["walk"]
    (torn / "cam2.times.txt").write_text("5.25000\n5.75000\n6.2")
    finish_recording(torn)
    assert {*recording_names(runs)} == {"walk", "torn"}
    assert recorded_times(torn / "cam2.avi") == (0.25, 0.75)
    finish_recording(runs / ".recorded/walk")
    assert recorded_times(runs / ".recorded/walk/cam1.avi") == (0.0, 0.5, 1.5)
