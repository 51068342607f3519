"""The video codec of this machine, and what was written with it."""

from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
"""(H, W, 3), blue, green, red; H and W are even."""
Put = Callable[[Picture], None]
"""Takes the next picture of a video."""


class Codec(NamedTuple):
    """A video codec and its container file."""

    name: str
    suffix: str
    code: str = ""
    """OpenCV's four letters of it; "" where PyAV writes it."""
    by: int = cv2.CAP_FFMPEG
    """OpenCV's number of the library that reads it, and writes it where PyAV does not."""


H264: Final = Codec("H.264", ".mp4")
MPEG4: Final = Codec("MPEG-4", ".mp4", "mp4v")
MOTION_JPEG: Final = Codec("Motion JPEG", ".avi", "MJPG", cv2.CAP_OPENCV_MJPEG)
CODECS: Final = (H264, MPEG4, MOTION_JPEG)
"""The codecs, best first: browsers play the first alone, and its files are a quarter of the
second's, a twenty-fifth of the third's. OpenCV from PyPI writes the second, every OpenCV the third.
"""


@cache
def best_codec() -> Codec:
    """The best codec that what is installed here can write."""
    if find_spec("av"):
        return H264
    return MPEG4 if cv2.CAP_FFMPEG in cv2.videoio_registry.getWriterBackends() else MOTION_JPEG


def pictures_in(path: Path, codec: Codec) -> int:
    """Number of pictures that a video claims; 0 where it is no video."""
    written = cv2.VideoCapture(str(path), codec.by)
    kept = int(written.get(cv2.CAP_PROP_FRAME_COUNT)) if written.isOpened() else 0
    written.release()
    return kept
