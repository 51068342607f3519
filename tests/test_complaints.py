"""What FFmpeg complains of and OpenCV does not tell: fields, damage, a lost end."""

import os
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from local_bus import LocalBus
from spoiling import damage

from common.bus.control_messages import Pulse
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.method import DEFAULT
from common.video.clip_facts import ClipView, shortfall, unread_facts
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from common.video.complaints import MOST_BYTES, Complaints
from common.video.decoding import Decoder
from common.video.pictures import Ending, Image
from runtime.live.screen import warnings_of
from viewer import __main__ as viewer
from viewer import track
from viewer.background.background import learn

FRAMES, HZ = 60, 15
SIZE = (160, 120)
PAL = (720, 576)
"""What DV holds: fields, whatever it shows."""


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    with Decoder() as shared:
        yield shared


def picture_of(index: int, size: tuple[int, int] = SIZE) -> Image:
    """A disc that moves before a wall of large spots."""
    spots = np.random.default_rng(0).integers(0, 255, (30, 40, 3), dtype=np.uint8)
    picture: Image = cv2.resize(spots, size)
    cv2.circle(picture, (20 + 2 * index, 60), 20, (200, 180, 90), -1)
    return picture


def shown(picture: Image) -> int:
    """Which of the pictures it is."""
    apart = [np.abs(picture.astype(float) - picture_of(n)).mean() for n in range(FRAMES)]
    return int(np.argmin(apart))


def written(path: Path, code: str, size: tuple[int, int] = SIZE, fps: float = HZ) -> Path:
    fourcc = cv2.VideoWriter.fourcc(*code)
    writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, fourcc, fps, size)
    for index in range(FRAMES):
        writer.write(picture_of(index, size))
    writer.release()
    return path


def read(path: Path, decoder: Decoder) -> tuple[ClipView, list[Image]]:
    """A file as a run opens it, and its pictures."""
    settings = Settings(cameras={"cam1": CameraSettings(source=str(path))})
    view = open_clip(settings, decoder).views[0]
    return view, [frame.picture for frame in decoder.frames(str(path), view.size)]


def test_what_goes_to_standard_error_is_taken_once_and_goes_nowhere_else(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Also of who says more than a pipe holds: neither waits for the other."""
    monkeypatch.setenv("OPENCV_FFMPEG_LOGLEVEL", "32")
    monkeypatch.setenv("OPENCV_FFMPEG_DEBUG", "1")
    kept = os.dup(2)
    try:
        complaints = Complaints()
        before = complaints.taken()
        os.write(2, b"one, ")
        os.write(2, b"two")
        os.write(2, bytes(2 * MOST_BYTES))
        with pytest.raises(BlockingIOError):
            os.write(2, b"more")
        taken = complaints.taken(), complaints.taken(), complaints.taken()
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(complaints._heard)
    assert before == b""
    assert taken[0][:10] == b"one, two\0\0"
    assert len(taken[0]) <= MOST_BYTES
    assert taken[2] == b""
    assert capfd.readouterr() == ("", "")
    assert not {"OPENCV_FFMPEG_LOGLEVEL", "OPENCV_FFMPEG_DEBUG"} & {*os.environ}


def test_a_video_of_fields_is_refused_with_the_cure(tmp_path: Path, decoder: Decoder) -> None:
    """OpenCV gives black pictures of it and calls them good."""
    path = written(tmp_path / "dv.avi", "dvsd", PAL, 25.0)
    with pytest.raises(ClipError, match=r"dv\.avi is interlaced: .* \(ffmpeg -i IN -vf yadif "):
        read(path, decoder)


def test_a_decoder_goes_on_behind_a_video_of_fields(tmp_path: Path, decoder: Decoder) -> None:
    bad = written(tmp_path / "dv.avi", "dvsd", PAL, 25.0)
    with pytest.raises(ClipError):
        read(bad, decoder)
    _, pictures = read(written(tmp_path / "good.avi", "MJPG"), decoder)
    assert decoder.ending == Ending(FRAMES, 0)
    assert shown(pictures[7]) == 7


@pytest.mark.parametrize(
    ("name", "code", "least", "most"),
    [("film.mp4", "mp4v", 10, 20), ("film.avi", "MJPG", 50, FRAMES - 1)],
    ids=["the decoder stops", "frames are lost"],
)
def test_damage_in_the_middle_is_told_with_how_much_was_read(
    tmp_path: Path, decoder: Decoder, name: str, code: str, least: int, most: int
) -> None:
    path = damage(written(tmp_path / name, code))
    view, pictures = read(path, decoder)
    assert least <= len(pictures) == decoder.ending.frames <= most
    told = f"{len(pictures)} of {FRAMES} frames could be read"
    assert told in shortfall(view, decoder.ending)
    lost = {str(path): {"read": len(pictures), "of": FRAMES}}
    assert unread_facts([(view, decoder.ending)]) == {"unread": lost}


def test_damage_that_costs_no_frame_is_told(tmp_path: Path, decoder: Decoder) -> None:
    path = damage(written(tmp_path / "film.avi", "MJPG"), 300)
    view, pictures = read(path, decoder)
    assert len(pictures) == FRAMES
    assert "film.avi is damaged in 1 of its 60 frames" in shortfall(view, decoder.ending)
    assert unread_facts([(view, decoder.ending)]) == {}


def test_a_video_whose_sound_is_longer_is_whole(tmp_path: Path, decoder: Decoder) -> None:
    """FLV and WMV tell no number of frames: it is guessed from their duration."""
    path = written(tmp_path / "film.flv", "FLV1")
    content = bytearray(path.read_bytes())
    struct.pack_into(">d", content, content.index(b"duration") + 9, FRAMES / HZ + 1.5)
    path.write_bytes(content)
    view, pictures = read(path, decoder)
    assert len(pictures) == FRAMES < view.frames
    assert shortfall(view, decoder.ending) == ""


def test_a_trimmed_video_is_whole(tmp_path: Path, decoder: Decoder) -> None:
    """A telephone trims by an edit list: what it hides stays in the file, and is counted."""
    path = written(tmp_path / "film.mp4", "mp4v")
    content, hidden = bytearray(path.read_bytes()), 20
    ticks_hz = struct.unpack_from(">I", content, content.index(b"mdhd") + 16)[0]
    struct.pack_into(">i", content, content.index(b"elst") + 16, hidden * ticks_hz // HZ)
    path.write_bytes(content)
    view, pictures = read(path, decoder)
    assert len(pictures) == FRAMES - hidden < view.frames
    assert shown(pictures[0]) == hidden
    assert shortfall(view, decoder.ending) == ""


class Over:
    """A live view behind its last frame."""

    over, odd, dropped, offset_s = True, (), 0, 0.0

    def __init__(self, ending: Ending) -> None:
        self.ending = ending


def test_a_live_run_is_told_how_much_of_a_view_was_read() -> None:
    """The last pulse carries it into the summary."""
    view = ClipView(2, "cam2.mp4", SIZE, SIZE, float(HZ), 228)
    state = track.init(track.Setup(2, None, Settings(), DEFAULT), learn([picture_of(0)]))
    bus = LocalBus()
    pulses = bus.subscribe(Pulse)
    live: Any = Over(Ending(15, damaged=1))
    viewer.run(viewer.Prepared(view, state), live, bus, threading.Event())
    last = pulses.drain()[-1]
    assert last.state == "ended"
    assert warnings_of({last.process: last}) == [shortfall(view, live.ending)]
    assert "15 of 228 frames could be read" in last.detail
