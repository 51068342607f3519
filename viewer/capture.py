"""Frames of one view: as fast as they can be decoded, or each at its moment."""

import threading
import time
from collections.abc import Iterator
from typing import Final, NamedTuple, Self

import msgspec

from common.bus.mailbox import Mailbox
from common.bus.rate import Clock, wait_until
from common.video.clip_facts import View
from common.video.decoding import Decoded, Decoder, Image
from common.video.frame_cache import Reader

WAITING: Final = 2
"""Frames that may wait for a late viewer: one hides a short delay, more would only be stale."""


class CapturedFrame(msgspec.Struct, frozen=True):
    """One picture and when it was taken."""

    index: int
    """Its place in the video, also where only every n-th frame is taken."""
    captured_s: float
    """Seconds since the clip began, or by the room's clock for a camera."""
    clock_s: float
    """The same moment by the room's clock; offline the same as `captured_s`."""
    picture: Image
    """(height, width, 3), BGR, at the working size."""
    next_s: float | None = None
    """`captured_s` of the next frame at the earliest; None for a camera, which does not know."""


def recorded(view: View, every: int, decoder: Reader) -> Iterator[CapturedFrame]:
    """Every n-th frame of a video, as fast as they come.

    Raises:
        Undecodable: When there is none.
        DecoderDied: When the decoder broke; the frames before that are good.
    """
    for decoded in decoder.frames(view.source, view.size, every):
        captured_s = view.captured_s(decoded.index)
        next_s = view.captured_s(decoded.index + every)
        yield CapturedFrame(decoded.index, captured_s, captured_s, decoded.picture, next_s)


class RoomClock(NamedTuple):
    """When a recorded clip begins, and how to tell the time in the room."""

    start_s: float
    """By the room's clock."""
    offset_s: float = 0.0
    """The room's clock less this host's monotonic one."""


class Live:
    """A view's frames, each given out when it is due; the oldest give way to a late reader.

    A thread takes them from the decoder, so a camera is never kept waiting. Frames that were due
    before it began, as when a viewer is started again in the middle of a clip, are not given out.
    """

    def __init__(
        self, view: View, every: int, room: RoomClock, clock: Clock = time.monotonic
    ) -> None:
        """Begin to decode at once; the first frame of a video comes at the room's start."""
        self._view = view
        self._room = room
        self._clock = clock
        self._began_s = clock()
        self._every = every
        self._missed = 0
        self._stop = threading.Event()
        self._decoder = Decoder()
        self._waiting: Mailbox[CapturedFrame] = Mailbox(WAITING)
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        """Already running."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the decoder and the thread."""
        self._stop.set()
        self._decoder.stop()
        self._thread.join()

    @property
    def offset_s(self) -> float:
        """The room's clock less this host's monotonic one."""
        return self._room.offset_s

    @property
    def dropped(self) -> int:
        """Frames that a late reader never saw, and those that were due before it began."""
        return self._waiting.dropped + self._missed

    @property
    def came(self) -> int:
        """How many frames the video really had; 0 until its end was reached."""
        return self._decoder.came

    @property
    def over(self) -> bool:
        """True when the last frame was taken."""
        return self._waiting.over

    def take(self, timeout_s: float) -> CapturedFrame | None:
        """The next frame; None when none came in time or it is over.

        Raises:
            Undecodable: When the source has no picture.
            DecoderDied: When the decoder broke, after the last good frame.
        """
        frame = self._waiting.take(timeout_s)
        if frame is None and self.over and self._failure is not None:
            raise self._failure
        return frame

    def _run(self) -> None:
        """Hand on each frame at its moment; in a thread of its own."""
        frames = self._decoder.frames(self._view.source, self._view.size, self._every)
        try:
            for decoded in frames:
                frame = self._timed(decoded)
                due_s = frame.clock_s - self._room.offset_s
                if not wait_until(due_s, self._stop, self._clock):
                    return
                if due_s < self._began_s:
                    self._missed += 1
                else:
                    self._waiting.put(frame)
        except Exception as error:  # Whatever ended this thread is the reader's to hear.
            self._failure = error
        finally:
            frames.close()
            self._decoder.close()
            self._waiting.close()

    def _timed(self, decoded: Decoded) -> CapturedFrame:
        if isinstance(self._view.source, int):
            now_s = decoded.grabbed_s + self._room.offset_s
            return CapturedFrame(decoded.index, now_s, now_s, decoded.picture)
        captured_s = self._view.captured_s(decoded.index)
        next_s = self._view.captured_s(decoded.index + self._every)
        clock_s = self._room.start_s + captured_s
        return CapturedFrame(decoded.index, captured_s, clock_s, decoded.picture, next_s)
