"""FFmpeg's error messages while OpenCV reads with it; OpenCV itself does not report them."""

import os
from typing import Final

MOST_BYTES: Final = 1 << 16
"""Bytes read at once; what exceeds a pipe is lost."""
STANDARD_ERROR: Final = 2
ELSEWHERE: Final = ("OPENCV_FFMPEG_LOGLEVEL", "OPENCV_FFMPEG_DEBUG")
"""Environment variables with which OpenCV sends the messages elsewhere, with others among them."""
INTERLACED: Final = b"interlaced"
"""Part of the message for an interlaced picture, which is not converted."""


class Complaints:
    """Captures the standard error of this process; nothing else receives it from then on."""

    def __init__(self) -> None:
        """Begin to capture, before the first source is opened."""
        self._heard, said = os.pipe()
        os.set_blocking(self._heard, False)
        os.set_blocking(said, False)
        os.dup2(said, STANDARD_ERROR)
        os.close(said)
        for name in ELSEWHERE:
            os.environ.pop(name, None)

    def taken(self) -> bytes:
        """The messages since the last call."""
        try:
            return os.read(self._heard, MOST_BYTES)
        except BlockingIOError:
            return b""
