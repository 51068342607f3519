"""How videos can be encoded here: `python -m animator.film_codec W H` tries and reports."""

import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np

TRIAL_S: Final = 20.0
"""A hardware encoder that takes longer for a few pictures is stuck."""
TRIAL_PICTURES: Final = 3


class Codec(NamedTuple):
    """A way to encode a video, and the file that it comes in."""

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
"""The best first: the first plays in browsers, the second is a tenth of the third's size, which
needs no library that may be missing. OpenCV as PyPI has it lacks the first."""


@cache
def best_codec(size: tuple[int, int]) -> Codec:
    """The best that this machine has for pictures of a size (width, height).

    Whether it works is known by trying, and it is tried in a process of its own: encoders print
    what they miss, and those of hardware may hang.
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
    """How many pictures a video says that it has; 0 where it is none."""
    written = cv2.VideoCapture(str(path), codec.by)
    kept = int(written.get(cv2.CAP_PROP_FRAME_COUNT)) if written.isOpened() else 0
    written.release()
    return kept


def works(codec: Codec, size: tuple[int, int]) -> bool:
    """Whether a video of a few pictures can be written, and is one."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"trial{codec.suffix}"
        code = cv2.VideoWriter.fourcc(*codec.code)
        writer = cv2.VideoWriter(str(path), codec.by, code, 15.0, size)
        for shade in range(TRIAL_PICTURES if writer.isOpened() else 0):
            writer.write(np.full((size[1], size[0], 3), 60 * shade, np.uint8))
        writer.release()
        return pictures_in(path, codec) == TRIAL_PICTURES


def main() -> None:
    """Print the name of the best codec for pictures of the size that is given."""
    size = int(sys.argv[1]), int(sys.argv[2])
    print(next(codec.name for codec in CODECS if works(codec, size)))


if __name__ == "__main__":
    main()
