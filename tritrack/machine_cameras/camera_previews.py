"""Live pictures of cameras, each taken in a thread of its own while the page shows them."""

import threading
import time
from collections.abc import Generator, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from animator.start.sections import Cameras, ShownCamera
from calibration.board.board_progress import HOLD_S, words_of
from common.config.picture_size import size_within
from common.video.clip_sources import ClipError
from common.video.clips import probed
from common.video.decoding import Decoder
from common.video.pictures import (
    Decoded,
    DecoderDied,
    Image,
    Size,
    Source,
    VideoInfo,
    is_recorded,
)
from tritrack.machine_cameras.board_watch import BoardWatch
from tritrack.machine_cameras.camera_list import FoundCamera, no_camera
from tritrack.marking.stills import Running, jpeg_of

BOUND: Final = (640, 480)
"""Bound of a preview, pixels: a board can be read in it."""


LOOKS: Final = 3
"""Looks at a board within which it is seen at rest: on a busy machine these take longer."""


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

    @property
    def newest(self) -> Image | None:
        """The newest picture."""
        return None if self._running is None else self._running.newest

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
            size = size_within((info.width, info.height), BOUND)
            reader = Playing(self._decoder, info)
            self._running = Running(reader, source, size)
        except (ClipError, DecoderDied) as error:
            self.fault = "" if self._closed.is_set() else str(error)


class Previews:
    """All cameras, open or not."""

    def __init__(self) -> None:
        self._open: dict[str, Preview] = {}
        self._watch: BoardWatch | None = None
        self._watched: tuple[str, ...] = ()
        self.looked_s = 0.0
        """When the page last asked for a picture."""

    @property
    def on(self) -> bool:
        """Whether they are open."""
        return bool(self._open)

    @property
    def watching(self) -> bool:
        """Whether the board is looked for."""
        return self._watch is not None and not self._watch.is_over

    def open(self, cameras: Sequence[FoundCamera]) -> None:
        """Open all of them."""
        self.looked_s = time.monotonic()
        for found in cameras:
            if found.camera not in self._open:
                self._open[found.camera] = Preview(found)

    def close(self) -> None:
        """Close all: only one program can hold a camera."""
        self.unwatch()
        for preview in self._open.values():
            preview.close()
        self._open = {}

    def jpeg(self, camera: str) -> bytes | None:
        """The newest picture of a camera; from any thread."""
        self.looked_s = time.monotonic()
        preview, watch = self._open.get(camera), self._watch
        picture = None if preview is None else preview.newest
        if picture is not None and watch is not None and camera in self._watched:
            picture = watch.shown(self._watched.index(camera), picture)
        return None if picture is None else jpeg_of(picture)

    def watch(self, cameras: Sequence[FoundCamera], folder: Path) -> None:
        """Look for the board in these cameras, which are opened, from now on.

        Args:
            cameras: In the order of their numbers.
            folder: Gets their pictures as videos.
        """
        self.unwatch()
        self.open(cameras)
        self._watched = tuple(found.camera for found in cameras)
        newest = [partial(_newest, self._open[camera]) for camera in self._watched]
        self._watch = BoardWatch(newest, folder)

    def unwatch(self) -> tuple[Path, ...]:
        """Look for it no longer; returns the videos of what it showed."""
        watch, self._watch = self._watch, None
        if watch is None:
            return ()
        watch.close()
        return tuple(path for path in watch.videos if path.is_file())

    def shown(self, cameras: Sequence[FoundCamera]) -> Cameras:
        """In the form for browsers."""
        rows = [
            self._open[each.camera].shown()
            if each.camera in self._open
            else ShownCamera(each.camera, each.name, each.where, "", "", "")
            for each in cameras
        ]
        says = "" if rows else no_camera("tritrack start")
        return Cameras(self.on, rows, says, self._watch is not None, self._board_words())

    def _board_words(self) -> tuple[str, ...]:
        watch = self._watch
        if watch is None:
            return ()
        if watch.fault or watch.progress is None:
            return (watch.fault or "The cameras give their first pictures ...",)
        names = [f"Camera {n}" for n in range(1, len(self._watched) + 1)]
        hold_s = max(HOLD_S, LOOKS * watch.period_s)
        return tuple(words_of(watch.progress, names, hold_s))


def _newest(preview: Preview) -> Image | None:
    return preview.newest
