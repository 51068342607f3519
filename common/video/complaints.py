"""What FFmpeg complains of while OpenCV reads with it: OpenCV itself is silent about it."""

import os
from typing import Final

MOST_BYTES: Final = 1 << 16
"""What is taken at once; of more than a pipe holds the rest is lost."""
STANDARD_ERROR: Final = 2
ELSEWHERE: Final = ("OPENCV_FFMPEG_LOGLEVEL", "OPENCV_FFMPEG_DEBUG")
"""Where one of these is set OpenCV sends them elsewhere, and others among them."""
INTERLACED: Final = b"interlaced"
"""In what is said of a picture of two fields, which is not converted."""


class Complaints:
    """The standard error of this process, which nobody else hears from then on."""

    def __init__(self) -> None:
        """Begin to listen, before the first source is opened."""
        self._heard, said = os.pipe()
        os.set_blocking(self._heard, False)
        os.set_blocking(said, False)
        os.dup2(said, STANDARD_ERROR)
        os.close(said)
        for name in ELSEWHERE:
            os.environ.pop(name, None)

    def taken(self) -> bytes:
        """What was said since this was last asked."""
        try:
            return os.read(self._heard, MOST_BYTES)
        except BlockingIOError:
            return b""
