"""Films on disk: every picture can be read again, and what cannot be written leaves no half."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from animator.video_codec import CODECS, H264, MPEG4, Codec
from animator.video_file import VideoError, WrittenVideo, write_video
from common.video.decoding import Decoder

SIZE = (122, 90)
PICTURES = [np.full((90, 122, 3), 20 * i, np.uint8) for i in range(6)]


def read(film: WrittenVideo) -> list[np.ndarray]:
    with Decoder() as decoder:
        assert decoder.probe(str(film.path)).fps == 15.0
        return [decoded.picture for decoded in decoder.frames(str(film.path), SIZE)]


@pytest.mark.parametrize("codec", CODECS, ids=[codec.name for codec in CODECS])
def test_every_picture_can_be_read_again(
    tmp_path: Path, codec: Codec, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("animator.video_file.best_codec", lambda: codec)
    film = write_video(tmp_path / "made" / "an overlay", PICTURES, 15.0)
    assert film.path == tmp_path / "made" / f"an overlay{codec.suffix}"
    assert [round(float(picture.mean()) / 20) for picture in read(film)] == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("gap_s", [0.008, 0.011, 0.013, 0.014, 1001 / 60_000, 0.04, 1.5, 0.0003])
@pytest.mark.parametrize("codec", [H264, MPEG4])
def test_a_film_of_any_rate_can_be_written(
    tmp_path: Path, gap_s: float, codec: Codec, monkeypatch: pytest.MonkeyPatch
) -> None:
    """MPEG-4 refuses 71.429 frames a second, which Matroska's 14 ms from frame to frame are."""
    monkeypatch.setattr("animator.video_file.best_codec", lambda: codec)
    film = write_video(tmp_path / "overlay", PICTURES, 1 / gap_s)
    with Decoder() as decoder:
        assert decoder.probe(str(film.path)).fps == pytest.approx(1 / gap_s, rel=1e-3)


def test_a_film_of_another_codec_does_not_outlive_its_successor(tmp_path: Path) -> None:
    """Who opens the run's folder would see the film of an earlier run."""
    for codec in CODECS:
        (tmp_path / f"overlay{codec.suffix}").write_bytes(b"older")
    film = write_video(tmp_path / "overlay", PICTURES, 15.0)
    assert list(tmp_path.iterdir()) == [film.path]


def test_a_film_that_broke_leaves_what_stood_there(tmp_path: Path) -> None:
    path = tmp_path / "overlay.mp4"
    path.write_bytes(b"older")
    with pytest.raises(VideoError, match=r"overlay.*does not follow"):
        write_video(tmp_path / "overlay", [PICTURES[0], PICTURES[0][:50]], 15.0)
    assert path.read_bytes() == b"older"
    assert [each.name for each in tmp_path.iterdir()] == ["overlay.mp4"]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(VideoError, match=r"file/overlay.*free"):
        write_video(tmp_path / "file" / "overlay", PICTURES, 15.0)


FULL_DISK = """
import resource, signal, sys
import numpy as np
from pathlib import Path
from animator.video_file import VideoError, write_video
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
noise = np.random.default_rng(0).integers(0, 255, (240, 320, 3), np.uint8)
try:
    write_video(Path(sys.argv[1]), [noise] * 20, 15.0)
except VideoError as error:
    print(error)
"""


def test_a_disk_that_is_full_is_told(tmp_path: Path) -> None:
    """OpenCV's writer says nothing by itself; a limit on the file's size stands for the disk."""
    path = tmp_path / "overlay"
    said = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(path)], capture_output=True, text=True, check=True
    ).stdout
    assert "overlay" in said
    assert "free some space" in said
    assert not list(tmp_path.iterdir())


def test_a_film_without_a_picture_is_none(tmp_path: Path) -> None:
    with pytest.raises(VideoError, match="no picture"):
        write_video(tmp_path / "none", [], 15.0)
    assert not list(tmp_path.iterdir())


def test_what_goes_wrong_while_filming_is_told_as_it_is(tmp_path: Path) -> None:
    def broken() -> Iterator[np.ndarray]:
        yield PICTURES[0]
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_video(tmp_path / "film", broken(), 15.0)
    assert not list(tmp_path.iterdir())
