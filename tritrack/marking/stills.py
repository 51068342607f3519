"""The pictures of the marking page: stills of each video, or a camera's newest picture."""

import math
import threading
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import Final, NamedTuple, Protocol

import cv2
import numpy as np
from rich.console import Console

from animator.marking.marking_page import LIVE, still_address
from animator.marking.sheet import Pictures
from common.config.picture_size import size_within
from common.config.settings import Settings
from common.video.clip_sources import NOTHING, ClipError, ViewSource, sources_of
from common.video.clips import SAME_ASPECT, probed
from common.video.decoding import Decoder
from common.video.pictures import Decoded, DecoderDied, Image, Size, Source, Wanted, is_camera
from runtime.terminal import bar

MOST_STILLS: Final = 100
"""Largest number of stills of each video, evenly spaced: markers do not move, and a pole that is
carried about rests."""
BOUND: Final = (1920, 1080)
"""Bound of the pictures' size, pixels; points are in these pixels."""
JPEG_QUALITY: Final = 92
FIRST_S: Final = 60.0
"""Seconds to wait for a camera's first picture; a stuck decoder is reported before."""


class Reader(Protocol):
    """Gives a source's pictures."""

    def frames(self, source: Source, size: Size) -> Generator[Decoded, None, None]:
        """All its pictures, reduced to a size."""

    def stop(self) -> None:
        """Stop, from any thread."""


class Film(NamedTuple):
    """Stills of a recorded video."""

    jpegs: tuple[bytes, ...]
    frames: tuple[int, ...]
    """Their indices in the video."""

    def jpeg(self, place: int) -> bytes | None:
        """A still, None where there is none."""
        return self.jpegs[place] if 0 <= place < len(self.jpegs) else None


class Running:
    """A camera's newest picture, taken in a thread of its own until `close`."""

    def __init__(self, reader: Reader, source: Source, size: Size) -> None:
        self._reader = reader
        self._newest: Image | None = None
        self._came, self._closed = threading.Event(), threading.Event()
        self.fault: Exception | None = None
        """Why it gives no more pictures."""
        self._thread = threading.Thread(target=self._read, args=(source, size), daemon=True)
        self._thread.start()
        if not self._came.wait(FIRST_S):
            self.fault = DecoderDied(source, 0, f"it gave no picture for {FIRST_S:g} s")

    @property
    def newest(self) -> Image | None:
        """The newest picture, None before the first; from any thread."""
        return self._newest

    def jpeg(self, place: int) -> bytes | None:
        """The newest picture, the only one."""
        newest = self._newest
        return None if newest is None or place != LIVE else jpeg_of(newest)

    def close(self) -> None:
        """Close the camera."""
        self._closed.set()
        self._reader.stop()
        self._thread.join()

    def _read(self, source: Source, size: Size) -> None:
        try:
            for decoded in self._reader.frames(source, size):
                self._newest = decoded.picture
                self._came.set()
        except Exception as error:
            self.fault = None if self._closed.is_set() else error
        finally:
            self._came.set()


class Album(NamedTuple):
    """The pictures of all views, of one size."""

    size: Size
    views: Mapping[int, Film | Running]
    """By camera, 1 or 2."""

    @property
    def pictures(self) -> tuple[Pictures, ...]:
        """In the form for browsers."""
        return tuple(_pictures(number, view) for number, view in self.views.items())

    def jpeg(self, camera: int, place: int) -> bytes | None:
        """A still, None where there is none."""
        return self.views[camera].jpeg(place) if camera in self.views else None

    def refuse_fault(self) -> None:
        """Check that every camera still runs.

        Raises:
            Undecodable, DecoderDied: When one does not; also any other error of its thread.
        """
        for view in self.views.values():
            if isinstance(view, Running) and view.fault is not None:
                raise view.fault


@contextmanager
def open_album(settings: Settings, console: Console) -> Iterator[Album]:
    """The pictures of a run's views; cameras run until the end.

    Raises:
        ClipError, Undecodable, DecoderDied: When a source cannot be opened, or the views' pictures
            differ in shape.
    """
    footage = sources_of(settings)
    if not footage:
        raise ClipError(NOTHING)
    with ExitStack() as doors:
        decoders = {view.number: doors.enter_context(Decoder()) for view in footage}
        infos = {view.number: probed(view.source, decoders[view.number]) for view in footage}
        size = common_size([(info.width, info.height) for info in infos.values()])
        views: dict[int, Film | Running] = {}
        for view in footage:
            decoder, frames = decoders[view.number], infos[view.number].frames
            if is_camera(view.source):
                running = Running(decoder, view.source, size)
                doors.callback(running.close)
                views[view.number] = running
            else:
                views[view.number] = _film(decoder, view, size, frames, console)
        yield Album(size, views)


def common_size(sizes: Sequence[Size]) -> Size:
    """The size of all shown pictures: no larger than any view's, nor than BOUND.

    Raises:
        ClipError: When their shapes differ, which no calibration allows.
    """
    first = min(sizes)
    for other in sizes:
        if abs(first[0] * other[1] / (first[1] * other[0]) - 1.0) > SAME_ASPECT:
            raise ClipError(
                "the cameras' pictures differ in shape ({}x{} and {}x{}): record both alike".format(
                    *first, *other
                )
            )
    return size_within(first, BOUND)


def _film(decoder: Decoder, view: ViewSource, size: Size, frames: int, console: Console) -> Film:
    every = max(1, math.ceil(frames / MOST_STILLS))
    with bar(console) as progress:
        taken = islice(decoder.frames(view.source, size, Wanted(every)), MOST_STILLS)
        told = progress.track(taken, total=math.ceil(frames / every) or None, description="reading")
        stills = [(decoded.index, jpeg_of(decoded.picture)) for decoded in told]
    return Film(tuple(jpeg for _, jpeg in stills), tuple(index for index, _ in stills))


def _pictures(number: int, view: Film | Running) -> Pictures:
    name = f"cam{number}"
    if isinstance(view, Running):
        return Pictures(number, name, (still_address(number, LIVE),), (0,), runs=True)
    addresses = tuple(still_address(number, place) for place in range(len(view.jpegs)))
    return Pictures(number, name, addresses, view.frames, runs=False)


def jpeg_of(picture: Image) -> bytes:
    """A picture for browsers."""
    _, encoded = cv2.imencode(".jpg", np.asarray(picture), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return encoded.tobytes()
