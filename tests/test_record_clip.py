"""Cameras recorded into a clip: files play as cameras, and the clip is one that is tracked."""

import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from spoiling import write_video

from common.atomic_file import FileRefused
from common.config.settings import Settings
from common.video import camera_file
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from tritrack.recording_cameras import record_clip
from tritrack.recording_cameras.camera_take import CameraTake
from tritrack.recording_cameras.record_clip import record_clip as recorded


@pytest.fixture(scope="module")
def cameras(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two videos of 40 frames, of 20 and 10 a second, each frame as bright as its number."""
    folder = tmp_path_factory.mktemp("cameras")
    film = [np.full((48, 64, 3), 5 * n, np.uint8) for n in range(40)]
    for name, fps in (("one.avi", 20.0), ("two.avi", 10.0)):
        write_video(folder / name, film, fps)
    return folder / "one.avi", folder / "two.avi"


def record(cameras: tuple[Path, ...], out: Path, seconds: float = 1.0, **more: Any) -> Any:
    sources, stop = [str(path) for path in cameras], more.pop("stop", threading.Event())
    return recorded(sources, out, seconds, stop, more.pop("tell", str), **more)


def test_a_recording_is_a_clip_with_the_time_of_each_frame(
    cameras: tuple[Path, Path], tmp_path: Path
) -> None:
    """A second of 20 and of 10 a second; what is read back are the pictures in their order."""
    shares: list[float] = []
    facts = record(cameras, tmp_path / "walk", share=shares.append)
    assert shares == sorted(shares)
    assert (shares[0] < 0.3, shares[-1]) == (True, 1.0)
    counts = [facts["cameras"][name]["frames"] for name in ("cam1", "cam2")]
    lasted_s = facts["seconds"]  # a busy machine sees the end later
    assert counts[0] == pytest.approx(20 * lasted_s, abs=3)
    assert counts[1] == pytest.approx(10 * lasted_s, abs=2)
    assert facts["why"] == "the time is over"
    assert facts["later_s"] == {"cam2": None}, "a second says nothing"
    clip = open_clip(Settings(clip=str(tmp_path / "walk")))
    assert [view.frames for view in clip.views] == counts
    for view, hz, count in zip(clip.views, (20.0, 10.0), counts, strict=True):
        assert view.fps == pytest.approx(10.0, rel=0.05), "the slower one's, for both"
        assert len(view.capture_s) == count
        assert np.diff(view.capture_s) == pytest.approx(np.full(count - 1, 1 / hz), abs=0.01)
    assert min(view.capture_s[0] for view in clip.views) == 0.0


@pytest.mark.slow
def test_it_ends_when_asked_to_when_a_camera_ends_and_when_the_disk_is_full(
    cameras: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    facts = record(cameras, tmp_path / "short", 30.0)
    assert facts["why"] == "cam1: it gave no more pictures"
    assert facts["cameras"]["cam1"]["fault"] == "it gave no more pictures"
    assert facts["seconds"] < 10
    stop = threading.Event()

    def tell(text: str) -> None:
        assert text == f"recording 2 cameras into {tmp_path / 'asked'}, 30 s at most"
        threading.Timer(0.6, stop.set).start()

    assert record(cameras, tmp_path / "asked", 30.0, stop=stop, tell=tell)["why"] == "asked to"
    monkeypatch.setattr(record_clip, "SPARE_BYTES", 1 << 62)
    monkeypatch.setattr(record_clip, "LOOK_S", 0.5)
    assert record(cameras, tmp_path / "full", 30.0)["why"] == "the disk is full"
    monkeypatch.undo()
    monkeypatch.setattr(camera_file, "MOST_BYTES", -1)
    monkeypatch.setattr(record_clip, "LOOK_S", 0.5)
    with pytest.raises(ClipError, match="gave 1 pictures: record longer"):
        record(cameras, tmp_path / "large", 30.0)


def test_what_cannot_be_recorded_is_refused_with_its_cure(
    cameras: tuple[Path, Path], tmp_path: Path
) -> None:
    with pytest.raises(ClipError, match="1 cameras: two to 8 make a clip"):
        record(cameras[:1], tmp_path / "one")
    with pytest.raises(ClipError, match=r"one\.avi is named twice: name two cameras"):
        record((cameras[0], cameras[1], cameras[0]), tmp_path / "twice")
    assert not (tmp_path / "twice").exists()
    with pytest.raises(ClipError, match=r"gone\.avi"):
        record((cameras[0], tmp_path / "gone.avi"), tmp_path / "two")
    assert not (tmp_path / "two").exists()
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "cam1.mp4").write_bytes(b"old")
    with pytest.raises(FileRefused, match="holds a clip: name another --out, or say --force"):
        record(cameras, tmp_path / "old")
    assert (tmp_path / "old" / "cam1.mp4").read_bytes() == b"old"
    record(cameras, tmp_path / "old", force=True)
    assert not (tmp_path / "old" / "cam1.mp4").exists()
    assert json.loads((tmp_path / "old" / "meta.json").read_text())["fps"].keys() == {
        "cam1",
        "cam2",
    }


@pytest.fixture(autouse=True)
def no_thread_is_left() -> Iterator[None]:
    yield
    names = {thread.name for thread in threading.enumerate()}
    assert not names & {"cam1", "cam2"}


def test_a_camera_that_plays_what_would_be_replaced_is_refused(
    cameras: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "walk"
    out.mkdir()
    played = out / "cam2.avi"
    played.write_bytes(cameras[0].read_bytes())
    with pytest.raises(FileRefused, match=r"cam2\.avi plays as a camera, and would be replaced"):
        record((cameras[1], played), out, force=True)
    assert played.read_bytes() == cameras[0].read_bytes()


def test_it_is_stopped_while_a_camera_does_not_answer(
    cameras: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its first picture would be waited for as long as READY_S."""
    stop, play = threading.Event(), CameraTake._played

    def late(take: CameraTake) -> Iterator[Any]:
        take._end.wait(30.0)
        yield from play(take)

    monkeypatch.setattr(CameraTake, "_played", late)
    threading.Timer(0.3, stop.set).start()
    with pytest.raises(ClipError, match="stopped before a picture was recorded"):
        record(cameras, tmp_path / "walk", stop=stop)
    with pytest.raises(ClipError, match="stopped before a picture was recorded"):
        record((tmp_path / "none.avi", tmp_path / "neither.avi"), tmp_path / "walk", stop=stop)
    assert not (tmp_path / "walk").exists()
