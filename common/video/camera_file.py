"""A camera's pictures in a video of their own, and the time of each."""

import json
import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np

from common.atomic_file import replacing
from common.video.pictures import Image, Size

SUFFIX: Final = ".avi"
TIMES: Final = ".times.txt"
"""Suffix of the text beside a file that is being written: the time of each picture, a line each."""
WHOLE: Final = re.compile(r"-?\d+\.\d+\n", re.ASCII)
"""A line of that text that was written to its end."""
MOST_BYTES: Final = 1_900_000_000
"""Size of a file, bytes: an AVI of the first kind ends at two gigabytes."""
SPARE_BYTES: Final = 1_000_000_000
"""What a recording keeps free on the disk, bytes."""
FINEST_HZ: Final = 65_535
"""Largest time scale of MPEG-4, ticks per second; OpenCV derives the scale from the rate's
digits."""


class CameraFile:
    """A video that grows picture by picture: MJPEG, which any tool cuts at any frame.

    A process that is killed leaves it readable, without its number of frames and the last 100 kB,
    and beside it the text with the times of its pictures.
    """

    def __init__(self, path: Path, size: Size, hz: float) -> None:
        """Replace what is at `path`; the times of the frames say what the rate was.

        Raises:
            OSError: When it cannot be written.
        """
        self.path = path
        self.times_s: list[float] = []
        """When each picture was taken."""
        code = cv2.VideoWriter.fourcc(*"MJPG")
        rate_hz = writable_hz(hz)
        self._writer = cv2.VideoWriter(str(path), cv2.CAP_OPENCV_MJPEG, code, rate_hz, size)
        if not self._writer.isOpened():
            raise OSError(f"cannot write {path}: see that its folder takes files")
        self._times = path.with_suffix(TIMES).open("w", encoding="ascii", buffering=1)

    def write(self, picture: Image, taken_s: float) -> None:
        """Add a picture of the file's size, and its time, seconds.

        Raises:
            OSError: When its time cannot be written.
        """
        self._writer.write(picture)
        self._times.write(f"{taken_s:.5f}\n")  # a line is on the disk at once
        self.times_s.append(taken_s)

    @property
    def is_full(self) -> bool:
        """Whether it took all that it can."""
        return self.path.stat().st_size > MOST_BYTES

    def close(self) -> None:
        """Write its index."""
        self._writer.release()
        with suppress(OSError):  # a full disk takes what is still to be written no better
            self._times.close()


def writable_hz(fps: float) -> float:
    """The rate, rounded to the digits that every codec accepts: off by less than a frame in
    10,000."""
    return round(fps, max(0, int(math.log10(FINEST_HZ / fps))))


def rate_of(times_s: Sequence[float], told_hz: float) -> float:
    """Frames a second, by the median step; `told_hz` where there are too few."""
    steps_s = np.diff(times_s)
    return 1.0 / float(np.median(steps_s)) if len(steps_s) else told_hz


def missing_of(times_s: Sequence[float]) -> int:
    """Number of frames that are missing, by the steps between those that came."""
    if len(times_s) < 2:
        return 0
    steps = np.diff(times_s) * rate_of(times_s, 1.0)
    return int(np.maximum(np.rint(steps) - 1, 0).sum())


def kept_times(folder: Path) -> dict[str, list[float]]:
    """When the pictures of each file in a folder were taken, seconds, by its name without suffix:
    of files that are being written, or whose process was killed.

    A line that was not written to its end ends the times. Files of fewer than two are left out.
    """
    found = {}
    for path in sorted(folder.glob(f"*{TIMES}")):
        lines = path.read_text(encoding="ascii", errors="replace").splitlines(keepends=True)
        times_s = [float(line) for line in takewhile(WHOLE.fullmatch, lines)]
        if len(times_s) > 1:
            found[path.name.removesuffix(TIMES)] = times_s
    return found


def finish_times(folder: Path) -> dict[str, list[float]]:
    """Make a clip of a folder's files: `meta.json` instead of the texts with their times.

    Returns:
        As `kept_times`; nothing is written where that is empty.

    Raises:
        OSError: When it cannot be written.
    """
    kept = kept_times(folder)
    if kept:
        write_times(folder, kept)
        for path in folder.glob(f"*{TIMES}"):
            path.unlink()
    return kept


def write_times(folder: Path, times_s: Mapping[str, Sequence[float]]) -> None:
    """Write `meta.json` beside a clip's videos: rate and times of each, from the first frame on.

    Args:
        folder: The clip's.
        times_s: By camera, seconds on one clock, two of each at least.

    Raises:
        OSError: When it cannot be written.
    """
    with replacing(folder / "meta.json") as new:
        new.write_text(json.dumps(timing_of(times_s), indent=1, allow_nan=False), encoding="utf-8")


def timing_of(times_s: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    """The content of a `meta.json` that says when the frames were taken.

    Args:
        times_s: By camera, seconds on one clock, two of each at least.
    """
    first_s = min((times[0] for times in times_s.values()), default=0.0)
    return {
        "fps": {name: round(rate_of(times, 1.0), 4) for name, times in times_s.items()},
        "capture_s": {
            name: [round(each - first_s, 5) for each in times] for name, times in times_s.items()
        },
    }
