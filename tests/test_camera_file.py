"""A camera's file: its pictures are read back in order, its times say rate and gaps."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from common.video import camera_file
from common.video.camera_file import (
    CameraFile,
    finish_times,
    kept_times,
    missing_of,
    rate_of,
    writable_hz,
    write_times,
)


def picture(level: int) -> np.ndarray:
    return np.full((48, 64, 3), level, np.uint8)


def test_what_is_written_is_read_back_in_order(tmp_path: Path) -> None:
    file = CameraFile(tmp_path / "cam1.avi", (64, 48), 15.0)
    for n in range(10):
        file.write(picture(20 * n), n / 15)
    file.close()
    assert file.times_s == [n / 15 for n in range(10)]
    capture = cv2.VideoCapture(str(file.path))
    levels = [capture.read()[1].mean() for _ in range(10)]
    assert levels == pytest.approx([20 * n for n in range(10)], abs=2)
    assert not capture.grab()


def test_a_file_is_full_at_its_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = CameraFile(tmp_path / "cam1.avi", (64, 48), 15.0)
    assert not file.is_full
    monkeypatch.setattr(camera_file, "MOST_BYTES", -1)
    assert file.is_full
    file.close()


def test_a_file_that_cannot_be_opened_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"cam1\.avi: see that its folder takes files"):
        CameraFile(tmp_path / "none" / "cam1.avi", (64, 48), 15.0)


def test_missing_frames_are_counted_by_their_times() -> None:
    times_s = [0.0, 0.1, 0.2, 0.5, 0.6, 0.8]
    assert rate_of(times_s, 30.0) == pytest.approx(10.0)
    assert missing_of(times_s) == 3
    assert (missing_of([0.0]), rate_of([0.0], 30.0)) == (0, 30.0)


def test_the_first_frame_of_all_cameras_begins_the_times(tmp_path: Path) -> None:
    write_times(tmp_path, {"cam1": [7.25, 7.5, 7.75], "cam2": [7.0, 7.5]})
    assert json.loads((tmp_path / "meta.json").read_text()) == {
        "fps": {"cam1": 4.0, "cam2": 2.0},
        "capture_s": {"cam1": [0.25, 0.5, 0.75], "cam2": [0.0, 0.5]},
    }


@pytest.mark.parametrize("fps", [15.0, 29.97, 1000 / 33, 240.0])
def test_a_rate_that_can_be_written_is_within_a_frame_of_ten_thousand(fps: float) -> None:
    assert writable_hz(fps) == pytest.approx(fps, rel=1e-4)


def test_a_file_that_was_not_closed_leaves_the_time_of_each_picture(tmp_path: Path) -> None:
    """What a killed process wrote of the last line alone is no time."""
    file = CameraFile(tmp_path / "cam1.avi", (64, 48), 15.0)
    for n in range(3):
        file.write(picture(n), 7.0 + n / 8)
    times = tmp_path / "cam1.times.txt"
    assert times.read_text() == "7.00000\n7.12500\n7.25000\n", "before it is closed"
    times.write_text(times.read_text() + "7.375")
    (tmp_path / "cam2.times.txt").write_text("7.00000\n\0\0\0\0")
    assert kept_times(tmp_path) == {"cam1": [7.0, 7.125, 7.25]}
    file.close()


def test_finished_times_are_in_meta_json_alone(tmp_path: Path) -> None:
    assert finish_times(tmp_path) == {}
    assert [*tmp_path.iterdir()] == []
    (tmp_path / "cam1.times.txt").write_text("7.00000\n7.25000\n7.50000\n")
    assert finish_times(tmp_path) == {"cam1": [7.0, 7.25, 7.5]}
    assert [path.name for path in tmp_path.iterdir()] == ["meta.json"]
    told = json.loads((tmp_path / "meta.json").read_text())
    assert told == {"fps": {"cam1": 4.0}, "capture_s": {"cam1": [0.0, 0.25, 0.5]}}
