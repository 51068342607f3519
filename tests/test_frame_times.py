"""Films whose rate varies: every container tells when a frame was taken, or the rate does."""

import struct
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path

import cv2
import numpy as np
import pytest
from spoiling import write_uneven, write_video

from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_facts import ClipView, shortfall
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.frame_times import timed
from common.video.pictures import VideoInfo
from viewer.capture import recorded

HZ = 30
GAPS = [1, 1, 3, 1, 2, 1, 1, 4, 1, 1, 1, 1, 2, 1, 1, 1]
"""Ticks of 1/30 s from a frame to the next, as a telephone gives them in the dark."""
TICKS = list(accumulate(GAPS, initial=0))
PICTURES = [np.full((48, 64, 3), 12 * n + 10, np.uint8) for n in range(len(TICKS))]


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    with Decoder() as shared:
        yield shared


def with_gaps(path: Path) -> None:
    """An AVI tells a gap by empty chunks: as many as frames are missing."""
    write_video(path, PICTURES, HZ)
    content = path.read_bytes()
    start = content.index(b"movi")
    at, movie, index = start + 4, b"movi", b""
    for missing in [0, *(gap - 1 for gap in GAPS)]:
        size = struct.unpack_from("<I", content, at + 4)[0]
        own = content[at : at + 8 + size + size % 2]
        for chunk in [b"00dc" + bytes(4)] * missing + [own]:
            index += b"00dc" + struct.pack("<III", 16, len(movie), len(chunk) - 8)
            movie += chunk
        at += len(own)
    head = bytearray(content[: start - 8])
    struct.pack_into("<I", head, 48, TICKS[-1] + 1)
    struct.pack_into("<I", head, head.index(b"strh") + 40, TICKS[-1] + 1)
    rest = b"LIST" + struct.pack("<I", len(movie)) + movie
    rest += b"idx1" + struct.pack("<I", len(index)) + index
    struct.pack_into("<I", head, 4, len(head) + len(rest) - 8)
    path.write_bytes(head + rest)


def uneven(path: Path) -> str:
    if path.suffix == ".avi":
        with_gaps(path)
    else:
        write_uneven(path, PICTURES, TICKS, HZ)
    return str(path)


def view_of(source: str, decoder: Decoder, fps: float = 0.0) -> ClipView:
    return open_clip(
        Settings(cameras={"cam1": CameraSettings(source=source)}, fps=fps), decoder
    ).views[0]


@pytest.mark.parametrize("suffix", [".mp4", ".mov", ".mkv", ".avi"])
def test_frames_are_where_their_container_puts_them(
    tmp_path: Path, decoder: Decoder, suffix: str
) -> None:
    """Matroska to the millisecond."""
    view = view_of(uneven(tmp_path / f"film{suffix}"), decoder)
    assert view.fps == pytest.approx(HZ, abs=1.0)
    assert view.frames == len(TICKS)
    frames = list(recorded(view, 1, decoder))
    assert shortfall(view, decoder.ending) == ""
    assert [frame.captured_s for frame in frames] == pytest.approx(
        [tick / HZ for tick in TICKS], abs=1e-3
    )
    shades = [round((float(frame.picture.mean()) - 10) / 12) for frame in frames]
    assert shades == list(range(len(TICKS)))


def test_a_packets_time_is_that_of_the_picture_decoded_of_it(tmp_path: Path) -> None:
    """OpenCV's own word on each picture, which costs decoding all of them."""
    source = uneven(tmp_path / "film.mp4")
    capture, seen = cv2.VideoCapture(source), []
    while capture.grab():
        seen.append(capture.get(cv2.CAP_PROP_POS_MSEC) / 1e3)
    with Decoder() as own:
        assert own.probe(source).shown_s == pytest.approx(seen)


@pytest.mark.parametrize("suffix", [".avi", ".mp4", ".mkv"])
def test_a_steady_film_keeps_its_rate_to_the_last_digit(
    tmp_path: Path, decoder: Decoder, suffix: str
) -> None:
    """Also where its container rounds: frame n of a film of 30 Hz is at n / 30."""
    path = tmp_path / f"steady{suffix}"
    if suffix == ".avi":
        write_video(path, PICTURES, HZ)
    else:
        write_uneven(path, PICTURES, range(len(PICTURES)), HZ)
    view = view_of(str(path), decoder)
    assert view.capture_s == ()
    assert [view.captured_s(n) for n in (0, 7)] == [0.0, 7 / HZ]


def test_the_users_word_goes_before_the_containers(tmp_path: Path, decoder: Decoder) -> None:
    source = uneven(tmp_path / "film.mp4")
    assert view_of(source, decoder, fps=25.0).captured_s(10) == 0.4
    (tmp_path / "meta.json").write_text('{"fps": 10}')
    assert view_of(source, decoder).captured_s(10) == 1.0


def test_a_film_cut_off_is_told_though_its_rate_varies(tmp_path: Path, decoder: Decoder) -> None:
    path = tmp_path / "film.mkv"
    uneven(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    view = view_of(str(path), decoder)
    list(recorded(view, 1, decoder))
    assert "was cut off or is damaged" in shortfall(view, decoder.ending)


def info_of(*shown_s: float) -> VideoInfo:
    return VideoInfo(64, 48, 10.0, len(shown_s), shown_s)


@pytest.mark.parametrize(
    ("shown_s", "trusted"),
    [
        pytest.param((0.0, 0.1, 0.35, 0.4), (0.0, 0.1, 0.35, 0.4), id="as they come"),
        pytest.param((0.0, 0.35, 0.1, 0.4), (0.0, 0.1, 0.35, 0.4), id="later ones first"),
        pytest.param((-0.2, -0.1, 0.0, 0.1, 0.35), (0.0, 0.1, 0.35), id="cut by an edit list"),
        pytest.param((5.0, 5.1, 5.35), (0.0, 0.1, 0.35), id="begun late"),
        pytest.param((0.0, 0.0, 0.0, 0.0), (), id="no times"),
        pytest.param((0.0, 0.1, 0.1, 0.4), (), id="two at once"),
        pytest.param((0.0, 0.1, 0.2, 0.3), (), id="steady"),
        pytest.param((0.0, 0.101, 0.199, 0.3), (), id="rounded"),
        pytest.param((7.0,), (), id="one frame"),
        pytest.param((), (), id="no packet"),
    ],
)
def test_times_are_believed_where_they_increase(
    shown_s: tuple[float, ...], trusted: tuple[float, ...]
) -> None:
    """By hand; at a rate of ten a second."""
    assert timed(info_of(*shown_s)).shown_s == pytest.approx(trusted)


def test_filmed_people_have_the_times_of_their_pictures(data_dir: Path) -> None:
    """H.264 whose frames refer to later ones, as telephones write it: packets are not in order."""
    source = str(data_dir / "real" / "frontside_walk" / "front.mp4")
    capture = cv2.VideoCapture(source)
    with Decoder() as own:
        shown_s = own.probe(source).shown_s
    assert list(shown_s) != sorted(shown_s)
    for moment in sorted(shown_s):
        assert capture.grab()
        assert capture.get(cv2.CAP_PROP_POS_MSEC) / 1e3 == pytest.approx(moment)
    assert not capture.grab()


@pytest.mark.parametrize(
    ("claimed", "frames"), [(4, 4), (3, 4), (8, 4), (10, 10)], ids=["right", "few", "guess", "cut"]
)
def test_a_film_has_the_frames_of_its_packets_unless_it_was_cut_off(
    claimed: int, frames: int
) -> None:
    """Four packets, the last at 0.4 s, the longest gap 0.25 s: eight frames of ten a second may be
    a guess from its 0.8 s, as 0.4 s may pass behind the last; ten are not."""
    told = timed(VideoInfo(64, 48, 10.0, claimed, (0.0, 0.1, 0.35, 0.4)))
    assert told.frames == frames
    assert told.fps == pytest.approx(10.0)  # of gaps of 0.1, 0.25 and 0.05


def test_a_film_is_steady_when_no_frame_is_farther_than_two_milliseconds_from_its_place() -> None:
    for off_s, steady in ((0.0019, True), (-0.0019, True), (0.0021, False), (-0.0021, False)):
        told = timed(info_of(0.0, 0.1, 0.2 + off_s, 0.3))
        assert (told.shown_s == ()) is steady
        assert told.fps == (10.0 if steady else pytest.approx(10.0))


def test_a_film_that_names_no_rate_has_that_of_its_usual_gap() -> None:
    told = timed(VideoInfo(64, 48, 0.0, 0, (0.0, 0.25, 0.5, 0.75)))
    assert (told.fps, told.frames, told.shown_s) == (4.0, 4, (0.0, 0.25, 0.5, 0.75))


@pytest.mark.parametrize(("claimed", "frames"), [(11, 8), (13, 13)])
def test_behind_the_last_frame_two_of_the_longest_gaps_may_pass(claimed: int, frames: int) -> None:
    """The last of eight packets at 0.8 s, the longest gap 0.2 s: 1.1 s may be guessed, 1.3 not."""
    shown_s = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.8)
    assert timed(VideoInfo(64, 48, 10.0, claimed, shown_s)).frames == frames
