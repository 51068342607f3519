"""Pictures that a live viewer keeps: all of them, or some dropped and said, never waited for."""

import shutil
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from common.video.camera_file import CameraFile, kept_times
from viewer import kept_pictures
from viewer.kept_pictures import FEWEST, KeptPictures


@pytest.fixture(autouse=True)
def no_thread_is_left() -> Iterator[None]:
    yield
    assert not [each for each in threading.enumerate() if each.name == "pictures 2"]


def picture(level: int) -> Any:
    return np.full((48, 64, 3), level, np.uint8)


def keep(kept: KeptPictures, count: int) -> None:
    for n in range(count):
        kept.take(picture(10 * n), 5.0 + n / 15)


def levels_of(path: Path) -> list[float]:
    capture, levels = cv2.VideoCapture(str(path)), []
    while capture.grab():
        levels.append(float(capture.retrieve()[1].mean()))
    return levels


def test_every_picture_is_in_the_file_with_its_time(tmp_path: Path) -> None:
    with KeptPictures(tmp_path, 2, 15.0) as kept:
        keep(kept, 20)
    assert levels_of(tmp_path / "cam2.avi") == pytest.approx(range(0, 200, 10), abs=2)
    times = kept_times(tmp_path)
    assert [*times] == ["cam2"]
    assert times["cam2"] == pytest.approx([5.0 + n / 15 for n in range(20)], abs=1e-5)
    assert kept.odd == ()


def test_without_a_picture_there_is_no_file(tmp_path: Path) -> None:
    with KeptPictures(tmp_path, 2, 15.0) as kept:
        assert kept.odd == ()
    assert [*tmp_path.iterdir()] == []
    assert kept_times(tmp_path) == {}


def test_a_viewer_that_is_started_again_begins_a_further_file(tmp_path: Path) -> None:
    for count in (3, 4, 1, 2):
        with KeptPictures(tmp_path, 2, 15.0) as kept:
            keep(kept, count)
    names = {"cam2": 3, "cam2_2": 4, "cam2_4": 2}
    assert {name: len(times) for name, times in kept_times(tmp_path).items()} == names
    assert len(levels_of(tmp_path / "cam2.avi")) == 3


def slow_down(monkeypatch: pytest.MonkeyPatch, wait: Callable[[], object]) -> None:
    """Let each picture wait before it is written."""
    write = CameraFile.write

    def slow(file: CameraFile, shown: Any, taken_s: float) -> None:
        wait()
        write(file, shown, taken_s)

    monkeypatch.setattr(CameraFile, "write", slow)


def test_a_slow_disk_drops_pictures_and_holds_no_one_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The oldest that wait are dropped; the times are of those that were written."""
    begin = threading.Event()
    slow_down(monkeypatch, lambda: begin.wait(5.0))
    monkeypatch.setattr(kept_pictures, "WAITING_BYTES", 1)
    with KeptPictures(tmp_path, 2, 15.0) as kept:
        kept.take(picture(0), 5.0)
        time.sleep(0.1)  # it is being written
        began_s = time.monotonic()
        keep(kept, 20)
        assert time.monotonic() - began_s < 0.5
        assert kept.odd == ("camera 2: the disk is too slow for all pictures: some are not kept",)
        begin.set()
    assert levels_of(tmp_path / "cam2.avi")[1:] == pytest.approx(range(160, 200, 10), abs=2)
    assert len(kept_times(tmp_path)["cam2"]) == 1 + FEWEST


def test_a_full_disk_ends_the_file_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_pictures, "SPARE_BYTES", 1 << 62)
    with KeptPictures(tmp_path, 2, 15.0) as kept:
        keep(kept, 5)
    assert kept.odd == ("camera 2: the disk is full after 1 pictures: none is kept from then on",)
    assert len(levels_of(tmp_path / "cam2.avi")) == 1


def test_a_full_file_ends_likewise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CameraFile, "is_full", property(lambda file: len(file.times_s) == 3))
    with KeptPictures(tmp_path, 2, 15.0) as kept:
        keep(kept, 5)
    assert "its file is full after 3 pictures" in kept.odd[0]
    assert len(levels_of(tmp_path / "cam2.avi")) == 3


def test_a_folder_that_is_gone_is_said_and_the_viewer_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    shutil.rmtree(folder)
    with KeptPictures(folder, 2, 15.0) as kept:
        keep(kept, 5)
    assert kept.odd[0].startswith("camera 2: its pictures cannot be written (cannot write ")


def test_a_disk_that_hangs_holds_up_the_end_for_a_bounded_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What still waits after that is not written."""
    slow_down(monkeypatch, lambda: time.sleep(0.2))
    monkeypatch.setattr(kept_pictures, "LAST_S", 0.3)
    with KeptPictures(tmp_path, 2, 15.0) as kept:
        keep(kept, 20)
    assert 1 <= len(levels_of(tmp_path / "cam2.avi")) <= 4
