"""One camera on its way into a file, in a thread of its own."""

import threading
import time
from collections.abc import Generator
from contextlib import closing
from pathlib import Path
from typing import Final

import numpy as np

from common.body.body import Vector
from common.bus.rate import wait_until
from common.video.camera_file import SUFFIX, CameraFile, missing_of, rate_of
from common.video.clips import probed
from common.video.decoding import Decoder
from common.video.pictures import Decoded, DecoderDied, Image, Source, Undecodable, is_recorded
from tritrack.recording_cameras.motion_delay import change, small_of

USUAL_HZ: Final = 30.0
"""Rate of a camera that reports none; the times of its frames say what it was."""


class CameraTake:
    """A camera whose pictures are written from `begin` to `end`."""

    def __init__(self, name: str, source: Source, folder: Path) -> None:
        """Open it; raises ClipError where it gives no picture."""
        self.name, self.source, self._path = name, source, folder / f"{name}{SUFFIX}"
        self.times_s: list[float] = []
        """When each written frame was taken, this host's monotonic clock."""
        self.changes: list[float] = []
        self.fault = ""
        self.is_full = False
        """Whether the file took all that it can."""
        self._decoder = Decoder()
        try:
            info = probed(source, self._decoder)
        except BaseException:
            self._decoder.close()
            raise
        self.size, self._hz = (info.width, info.height), info.fps or USUAL_HZ
        self.is_ready, self._begin, self._end = (threading.Event() for _ in range(3))
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def begin(self) -> None:
        """Write from the next picture on."""
        self._begin.set()

    def end(self) -> None:
        """Stop, and close the file."""
        self._end.set()
        self._decoder.stop()
        self._thread.join()
        self._decoder.close()

    @property
    def is_over(self) -> bool:
        """Whether it gives no more pictures."""
        return not self._thread.is_alive()

    @property
    def rate_hz(self) -> float:
        """Frames a second, by their times; what the camera says where there are too few."""
        return rate_of(self.times_s, self._hz)

    @property
    def dropped(self) -> int:
        """Frames that are missing, by the steps between those that came."""
        return missing_of(self.times_s)

    @property
    def motion(self) -> tuple[Vector, Vector]:
        """Times, and how much each picture differs from the one before."""
        return np.array(self.times_s), np.array(self.changes)

    def _run(self) -> None:
        file: CameraFile | None = None
        before: Image | None = None
        try:
            with closing(self._played()) as frames:
                for decoded in frames:
                    self.is_ready.set()
                    if self._end.is_set() or self.is_full:
                        return
                    small = small_of(decoded.picture)
                    if self._begin.is_set():
                        file = file or self._opened()
                        file.write(decoded.picture, decoded.grabbed_s)
                        self.changes.append(change(before, small))
                        self.is_full = file.is_full
                    before = small
            if not self._end.is_set():
                self.fault = "it gave no more pictures"
        except (Undecodable, DecoderDied, OSError) as error:
            self.fault = "" if self._end.is_set() else str(error)
        finally:
            self.is_ready.set()
            if file is not None:
                file.close()

    def _opened(self) -> CameraFile:
        file = CameraFile(self._path, self.size, self._hz)
        self.times_s = file.times_s
        return file

    def _played(self) -> Generator[Decoded, None, None]:
        """A camera's pictures as they come, a file's at its pace."""
        began_s = time.monotonic()
        for decoded in self._decoder.frames(self.source, self.size):
            if is_recorded(self.source):
                due_s = began_s + decoded.index / self._hz
                if not wait_until(due_s, self._end, time.monotonic):
                    return
                yield Decoded(decoded.index, due_s, decoded.picture)
            else:
                yield decoded
