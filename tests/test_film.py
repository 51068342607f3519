"""Films on disk: every picture can be read again, and what cannot be written leaves no half."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from animator.film import FilmError, filming
from common.video.decoding import Decoder

PICTURES = [np.full((90, 122, 3), 20 * i, np.uint8) for i in range(6)]


def filmed(path: Path, pictures: list[np.ndarray]) -> None:
    with filming(path, 15.0) as film:
        for picture in pictures:
            film.write(picture)


def test_every_picture_can_be_read_again(tmp_path: Path) -> None:
    path = tmp_path / "made" / "overlay.avi"
    filmed(path, PICTURES)
    with Decoder() as decoder:
        assert decoder.probe(str(path)).fps == 15.0
        read = [decoded.picture for decoded in decoder.frames(str(path), (122, 90))]
    assert [round(float(picture.mean()) / 20) for picture in read] == [0, 1, 2, 3, 4, 5]


def test_a_film_that_broke_leaves_what_stood_there(tmp_path: Path) -> None:
    path = tmp_path / "overlay.avi"
    path.write_bytes(b"older")
    with pytest.raises(FilmError, match=r"overlay\.avi.*does not follow"):
        filmed(path, [PICTURES[0], PICTURES[0][:50]])
    assert path.read_bytes() == b"older"
    assert [each.name for each in tmp_path.iterdir()] == ["overlay.avi"]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(FilmError, match=r"file/overlay\.avi.*free"):
        filmed(tmp_path / "file" / "overlay.avi", PICTURES)


FULL_DISK = """
import resource, signal, sys
import numpy as np
from pathlib import Path
from animator.film import FilmError, filming
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
noise = np.random.default_rng(0).integers(0, 255, (240, 320, 3), np.uint8)
try:
    with filming(Path(sys.argv[1]), 15.0) as film:
        for _ in range(20):
            film.write(noise)
except FilmError as error:
    print(error)
"""


def test_a_disk_that_is_full_is_told(tmp_path: Path) -> None:
    """OpenCV's writer says nothing by itself; a limit on the file's size stands for the disk."""
    path = tmp_path / "overlay.avi"
    said = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(path)], capture_output=True, text=True, check=True
    ).stdout
    assert "overlay.avi" in said
    assert "free some space" in said
    assert not list(tmp_path.iterdir())


def test_a_film_without_a_picture_is_none(tmp_path: Path) -> None:
    with pytest.raises(FilmError, match="no picture"):
        filmed(tmp_path / "none.avi", [])
    assert not list(tmp_path.iterdir())


def test_what_goes_wrong_while_filming_is_told_as_it_is(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), filming(tmp_path / "film.avi", 15.0):
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
