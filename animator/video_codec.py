"""Available video codecs: `python -m animator.video_codec W H` tries them and prints the best."""

import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np

TRIAL_S: Final = 20.0
"""Seconds after which a hardware encoder that was given a few pictures is stuck."""
TRIAL_PICTURES: Final = 3


class Codec(NamedTuple):
    """A video codec and its container file."""

    name: str
    code: str
    suffix: str
    by: int
    """OpenCV's number of the library that writes it."""


CODECS: Final = (
    Codec("H.264", "avc1", ".mp4", cv2.CAP_FFMPEG),
    Codec("MPEG-4", "mp4v", ".mp4", cv2.CAP_FFMPEG),
    Codec("Motion JPEG", "MJPG", ".avi", cv2.CAP_OPENCV_MJPEG),
)
"""The codecs, best first: the first plays in browsers; the second's files are a tenth of the
third's, which needs no optional library. OpenCV from PyPI lacks the first."""


@cache
def best_codec(size: tuple[int, int]) -> Codec:
    """The best codec of this machine for pictures of a size (width, height).

    Each is tried in a process of its own: encoders print what they lack, and hardware encoders may
    hang.
    """
    asked = [sys.executable, "-P", "-m", __name__, *map(str, size)]
    try:
        told = subprocess.run(asked, capture_output=True, timeout=TRIAL_S, check=False)
    except subprocess.TimeoutExpired:
        return CODECS[-1]
    names = [codec.name for codec in CODECS]
    name = told.stdout.decode(errors="replace").strip()
    return CODECS[names.index(name)] if name in names else CODECS[-1]


def pictures_in(path: Path, codec: Codec) -> int:
    """Number of pictures that a video claims; 0 where it is no video."""
    written = cv2.VideoCapture(str(path), codec.by)
    kept = int(written.get(cv2.CAP_PROP_FRAME_COUNT)) if written.isOpened() else 0
    written.release()
    return kept


def works(codec: Codec, size: tuple[int, int]) -> bool:
    """Whether a video of a few pictures can be written and read back."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"trial{codec.suffix}"
        code = cv2.VideoWriter.fourcc(*codec.code)
        writer = cv2.VideoWriter(str(path), codec.by, code, 15.0, size)
        for shade in range(TRIAL_PICTURES if writer.isOpened() else 0):
            writer.write(np.full((size[1], size[0], 3), 60 * shade, np.uint8))
        writer.release()
        return pictures_in(path, codec) == TRIAL_PICTURES


def main() -> None:
    """Print the name of the best codec for pictures of the given size."""
    size = int(sys.argv[1]), int(sys.argv[2])
    print(next(codec.name for codec in CODECS if works(codec, size)))


if __name__ == "__main__":
    main()
