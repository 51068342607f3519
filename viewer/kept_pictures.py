"""A live view's pictures, written into the run's folder while the viewer goes on."""

import logging
import shutil
import threading
import time
from pathlib import Path
from typing import Final, NamedTuple, Self

from common.bus.mailbox import Mailbox
from common.bus.messages import ViewerNumber
from common.video.camera_file import SPARE_BYTES, SUFFIX, CameraFile
from common.video.pictures import Image

WAITING_BYTES: Final = 64_000_000
"""Size of the pictures that may wait for a slow disk: two thirds of a second of 1280x720 at 30."""
FEWEST: Final = 4
"""Number of pictures that may wait however large they are."""
LOOK_S: Final = 0.5
LAST_S: Final = 2.0
"""How long the pictures that still wait are written at the end, seconds."""
SLOW: Final = "the disk is too slow for all pictures: some are not kept"

log = logging.getLogger(__name__)


class _Taken(NamedTuple):
    picture: Image
    taken_s: float


class KeptPictures:
    """Takes a view's pictures from a thread that must not wait, and writes them in one of its own.

    Those that find no room are dropped, the oldest first. A viewer that is started again begins a
    further file: `cam1.avi`, then `cam1_2.avi`.
    """

    def __init__(self, folder: Path, viewer: ViewerNumber, hz: float) -> None:
        """Ready to write into a folder that is there; a file begins with the first picture."""
        self._folder, self._viewer, self._hz = folder, viewer, hz
        self._waiting: Mailbox[_Taken] | None = None
        self._thread = threading.Thread(target=self._run, name=f"pictures {viewer}", daemon=True)
        self._until_s, self._over = 0.0, ""

    def __enter__(self) -> Self:
        """Nothing to do before the first picture."""
        return self

    def __exit__(self, *_: object) -> None:
        """Write what still waits, LAST_S at most, and close the file."""
        if self._waiting is not None:
            self._until_s = time.monotonic() + LAST_S
            self._waiting.close()
            self._thread.join(2 * LAST_S)

    @property
    def odd(self) -> tuple[str, ...]:
        """What went wrong so far, one line each."""
        slow = self._waiting is not None and self._waiting.dropped > 0
        lines = (SLOW if slow else "", self._over)
        return tuple(f"camera {self._viewer}: {line}" for line in lines if line)

    def take(self, picture: Image, taken_s: float) -> None:
        """A picture of the view, all of one size, and when it was taken, seconds of the run."""
        if self._waiting is None:
            self._waiting = Mailbox(max(FEWEST, WAITING_BYTES // picture.nbytes))
            self._thread.start()
        self._waiting.put(_Taken(picture, taken_s))

    def _run(self) -> None:
        assert self._waiting is not None
        file: CameraFile | None = None
        try:
            while not (self._over or self._waiting.over or self._is_late):
                taken = self._waiting.take(LOOK_S)
                if taken is None:
                    continue
                file = file or self._opened(taken.picture)
                self._write(file, taken)
        except OSError as error:
            self._over = f"its pictures cannot be written ({error}): none is kept from then on"
        finally:
            self._waiting.close()
            if file is not None:
                file.close()
            if self._over:
                log.warning("camera %d: %s", self._viewer, self._over)

    @property
    def _is_late(self) -> bool:
        return 0.0 < self._until_s < time.monotonic()

    def _opened(self, picture: Image) -> CameraFile:
        height, width = picture.shape[:2]
        path = _next_file(self._folder, self._viewer)
        return CameraFile(path, (width, height), self._hz)

    def _write(self, file: CameraFile, taken: _Taken) -> None:
        """Write one picture and its time; say so where it was the last."""
        file.write(*taken)
        why = "its file is full" if file.is_full else ""
        if shutil.disk_usage(self._folder).free < SPARE_BYTES:
            why = "the disk is full"
        if why:
            count = len(file.times_s)
            self._over = f"{why} after {count} pictures: none is kept from then on"


def _next_file(folder: Path, viewer: ViewerNumber) -> Path:
    """The file of a camera that is not there yet: its own, or of a viewer started again."""
    name, part = f"cam{viewer}", 1
    while (path := folder / f"{name}{SUFFIX}").exists():
        part += 1
        name = f"cam{viewer}_{part}"
    return path
