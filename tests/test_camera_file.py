"""A camera's file: its pictures are read back in order, its times say rate and gaps."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from common.video import camera_file
from common.video.camera_file import CameraFile, missing_of, rate_of, writable_hz, write_times


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
