"""A film on disk: pictures written one after the other, whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.atomic_file import replacing

CODEC: Final = "MJPG"
"""Motion JPEG in an AVI, by OpenCV's own writer: it needs no library that may be missing."""


class FilmError(RuntimeError):
    """A film that cannot be written: the text names it and the cure."""


class FilmWriter:
    """A film that grows by pictures of one size; made by `filming`."""

    def __init__(self, path: Path, fps: float) -> None:
        """Nothing is opened before the first picture tells the size."""
        self._path, self._fps = path, fps
        self._writer: Any = None
        self._size = (0, 0)
        self.pictures = 0

    def write(self, picture: NDArray[np.uint8]) -> None:
        """Add a picture, (H, W, 3), blue, green, red; as large as the first.

        Raises:
            FilmError: When no film can be written there.
        """
        size = (picture.shape[1], picture.shape[0])
        if self._writer is None:
            fourcc = cv2.VideoWriter.fourcc(*CODEC)
            path = str(self._path)
            self._writer = cv2.VideoWriter(path, cv2.CAP_OPENCV_MJPEG, fourcc, self._fps, size)
            self._size = size
        if not self._writer.isOpened():
            raise FilmError("the film cannot be opened for writing")
        if size != self._size:
            raise FilmError(f"a picture of {size} does not follow those of {self._size}")
        self._writer.write(picture)
        self.pictures += 1

    def close(self) -> None:
        """End the file.

        Raises:
            FilmError: When it does not hold every picture: OpenCV says nothing of a full disk.
        """
        if self._writer is None:
            raise FilmError("it got no picture")
        self._writer.release()
        written = cv2.VideoCapture(str(self._path), cv2.CAP_OPENCV_MJPEG)
        kept = int(written.get(cv2.CAP_PROP_FRAME_COUNT)) if written.isOpened() else 0
        written.release()
        if kept != self.pictures:
            raise FilmError(f"only {kept} of {self.pictures} pictures could be written")


@contextmanager
def filming(path: Path, fps: float) -> Iterator[FilmWriter]:
    """A film that takes its place at `path`, an .avi, when the block ends well.

    Raises:
        FilmError: When it cannot be written; what stood there before is untouched.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as new:
            film = FilmWriter(new, fps)
            yield film
            film.close()
    except (OSError, FilmError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise FilmError(
            f"cannot write {path}: {reason}; free some space or name another folder"
        ) from error
