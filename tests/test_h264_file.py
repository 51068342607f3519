"""Videos that browsers play: what PyAV finds in them again."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np

from animator.h264_file import h264_writer, is_h264


def test_a_video_is_h264_of_its_rate_in_the_pixels_that_browsers_decode(tmp_path: Path) -> None:
    """4:2:0 alone; 4:4:4, which x264 writes too, stays black in them. Blue stays blue."""
    blue = np.full((90, 122, 3), (255, 0, 0), np.uint8)
    with h264_writer(tmp_path / "a.mp4", (122, 90), 30_000 / 1001) as put:
        for _ in range(5):
            put(blue)
    with av.open(str(tmp_path / "a.mp4")) as container:
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.pix_fmt) == ("h264", "yuv420p")
        assert (stream.width, stream.height, stream.frames) == (122, 90, 5)
        assert stream.average_rate == Fraction(30_000, 1001)
        pictures = [frame.to_ndarray(format="bgr24") for frame in container.decode(stream)]
    assert len(pictures) == 5
    assert np.abs(np.array(pictures, int) - blue).max() < 12


def test_a_browser_may_begin_before_the_file_is_whole(tmp_path: Path) -> None:
    """The index stands before the pictures."""
    with h264_writer(tmp_path / "a.mp4", (64, 48), 15.0) as put:
        put(np.zeros((48, 64, 3), np.uint8))
    content = (tmp_path / "a.mp4").read_bytes()
    assert content.index(b"moov") < content.index(b"mdat")


def test_another_codec_in_the_same_container_is_told_apart(
    tmp_path: Path, monkeypatch: Any
) -> None:
    with h264_writer(tmp_path / "a.mp4", (64, 48), 15.0) as put:
        put(np.zeros((48, 64, 3), np.uint8))
    with av.open(str(tmp_path / "b.mp4"), "w") as container:
        stream = container.add_stream("mpeg4", 15)
        stream.width, stream.height = 64, 48
        picture = av.VideoFrame.from_ndarray(np.zeros((48, 64, 3), np.uint8), format="bgr24")
        container.mux(stream.encode(picture))
        container.mux(stream.encode(None))
    (tmp_path / "c.mp4").write_bytes(b"ftyp" * 9)
    names = ("a.mp4", "b.mp4", "c.mp4", "missing.mp4")
    assert [is_h264(tmp_path / name) for name in names] == [True, False, False, False]
    monkeypatch.setattr("animator.h264_file.find_spec", lambda name: None)
    assert not is_h264(tmp_path / "a.mp4")
