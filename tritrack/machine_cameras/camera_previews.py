"""Live pictures of cameras, each taken in a thread of its own while the page shows them."""

import threading
import time
from collections.abc import Generator, Sequence
from typing import Final

from animator.marking.marking_page import LIVE
from animator.start.sections import Cameras, ShownCamera
from common.config.picture_size import working_size
from common.video.clip_sources import ClipError
from common.video.clips import probed
from common.video.decoding import Decoder
from common.video.pictures import (
    Decoded,
    DecoderDied,
    Size,
    Source,
    VideoInfo,
    is_recorded,
)
from tritrack.machine_cameras.camera_list import FoundCamera, no_camera
from tritrack.marking.stills import Running

BOUND: Final = (320, 240)
"""Bound of a preview, pixels."""


class Playing:
    """A reader that plays a file at its own pace, again and again, and a camera as it is."""

    def __init__(self, decoder: Decoder, info: VideoInfo) -> None:
        self._decoder, self._period_s = decoder, 1.0 / (info.fps or 15.0)
        self._over = threading.Event()

    def frames(self, source: Source, size: Size) -> Generator[Decoded, None, None]:
        """All its pictures."""
        while not self._over.is_set():
            for decoded in self._decoder.frames(source, size):
                yield decoded
                if is_recorded(source) and self._over.wait(self._period_s):
                    break
            if not is_recorded(source):
                return

    def stop(self) -> None:
        """Stop, from any thread."""
        self._over.set()
        self._decoder.stop()


class Preview:
    """One camera: opened in a thread, so that the page never waits for it."""

    def __init__(self, found: FoundCamera) -> None:
        self.found = found
        self.facts, self.fault = "", ""
        self._running: Running | None = None
        self._decoder, self._closed = Decoder(), threading.Event()
        self._thread = threading.Thread(target=self._open, daemon=True)
        self._thread.start()

    def jpeg(self) -> bytes | None:
        """The newest picture."""
        return None if self._running is None else self._running.jpeg(LIVE)

    def shown(self) -> ShownCamera:
        """In the form for browsers."""
        running = self._running
        gone = running is not None and running.fault is not None
        address = "" if running is None or gone else f"camera/{self.found.camera}.jpg"
        fault = self.fault or (str(running.fault) if running is not None and gone else "")
        return ShownCamera(
            self.found.camera, self.found.name, self.found.where, self.facts, fault, address
        )

    def close(self) -> None:
        """Close the camera."""
        self._closed.set()
        self._decoder.stop()
        self._thread.join()
        if self._running is not None:
            self._running.close()
        self._decoder.close()

    def _open(self) -> None:
        source = self.found.source
        try:
            info = probed(source, self._decoder)
            rate = f"{info.fps:.4g} frames a second" if info.fps else "rate not told"
            self.facts = f"{info.width}x{info.height}, {rate}"
            size = working_size((info.width, info.height), BOUND)
            reader = Playing(self._decoder, info)
            self._running = Running(reader, source, size)
        except (ClipError, DecoderDied) as error:
            self.fault = "" if self._closed.is_set() else str(error)


class Previews:
    """All cameras, open or not."""

    def __init__(self) -> None:
        self._open: dict[str, Preview] = {}
        self.looked_s = 0.0
        """When the page last asked for a picture."""

    @property
    def on(self) -> bool:
        """Whether they are open."""
        return bool(self._open)

    def open(self, cameras: Sequence[FoundCamera]) -> None:
        """Open all of them."""
        self.looked_s = time.monotonic()
        for found in cameras:
            if found.camera not in self._open:
                self._open[found.camera] = Preview(found)

    def close(self) -> None:
        """Close all: only one program can hold a camera."""
        for preview in self._open.values():
            preview.close()
        self._open = {}

    def jpeg(self, camera: str) -> bytes | None:
        """The newest picture of a camera; from any thread."""
        self.looked_s = time.monotonic()
        preview = self._open.get(camera)
        return None if preview is None else preview.jpeg()

    def shown(self, cameras: Sequence[FoundCamera]) -> Cameras:
        """In the form for browsers."""
        rows = [
            self._open[each.camera].shown()
            if each.camera in self._open
            else ShownCamera(each.camera, each.name, each.where, "", "", "")
            for each in cameras
        ]
        return Cameras(self.on, rows, "" if rows else no_camera("tritrack start"))
