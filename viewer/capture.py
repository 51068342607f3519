"""Frames of one view: as fast as they can be decoded, or each at its time."""

import threading
import time
from collections.abc import Iterator
from typing import Final, NamedTuple, Self

import msgspec

from common.bus.mailbox import Mailbox
from common.bus.rate import Clock, wait_until
from common.video.clip_facts import ClipView
from common.video.decoding import Decoder
from common.video.pictures import CameraLost, Decoded, Ending, Reader, Size, Wanted, is_camera
from viewer.captured_frame import CapturedFrame
from viewer.kept_pictures import KeptPictures
from viewer.landmarks.outside_source import OutsideSource

WAITING: Final = 2
"""Frames that may wait for a late viewer: one bridges a short delay, more would be outdated."""

PATIENCE_S: Final = 30.0
"""How long to wait for a recorded frame's landmarks, where nothing is late."""


def recorded(
    view: ClipView, every: int, decoder: Reader, source: OutsideSource | None = None, start: int = 0
) -> Iterator[CapturedFrame]:
    """Every n-th frame of a video, as fast as they come.

    Args:
        view: The view that the video belongs to.
        every: The stride n.
        decoder: Reads it.
        source: Asked for the landmarks of every frame, and waited for.
        start: Index in the video of the first frame wanted.

    Raises:
        Undecodable: When there is no frame.
        DecoderDied: When the decoder crashed; the frames before are valid.
    """
    large = source.large if source else None
    wanted = Wanted(view.every(every), start, large, view.quarters)
    for decoded in decoder.frames(view.source, view.size, wanted):
        if not view.is_looked_at(decoded.index):
            continue
        moment_s = view.captured_s(decoded.index)
        next_s = view.next_s(decoded.index, every)
        people = source.people(decoded, PATIENCE_S) if source else ()
        yield CapturedFrame(
            decoded.index, moment_s, moment_s, decoded.picture, next_s, people, view.upright
        )


class RoomClock(NamedTuple):
    """The start of a recorded clip, and the room's clock."""

    start_s: float
    """Start by the room's clock."""
    offset_s: float = 0.0
    """The room's clock minus this host's monotonic one."""


class Live:
    """A view's frames, each delivered when it is due; the oldest are dropped for a late reader.

    A thread takes them from the decoder, so a camera never has to wait. Frames that were due before
    this began, as after a restart in the middle of a clip, are not delivered.
    """

    def __init__(
        self,
        view: ClipView,
        every: int,
        room: RoomClock,
        source: OutsideSource | None = None,
        clock: Clock = time.monotonic,
        decoder: Decoder | None = None,
        kept: KeptPictures | None = None,
    ) -> None:
        """Begin to decode at once; the first frame of a video is due at the room's start.

        The source is asked for the landmarks of every frame, and waited for until the next is due.
        The decoder, a new one where none is given, ends with this. `kept` gets the whole picture of
        every frame, or as large a one as the source asks for.
        """
        self._view = view
        self._source = source
        self._kept = kept
        self._room = room
        self._clock = clock
        self._began_s = clock()
        self._every = every
        self._missed = 0
        self._first_index: int | None = None
        self._stop = threading.Event()
        self._decoder = decoder or Decoder()
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
        """The room's clock minus this host's monotonic one."""
        return self._room.offset_s

    def set_offset(self, offset_s: float) -> None:
        """The same, updated: clocks of two hosts drift apart."""
        self._room = self._room._replace(offset_s=offset_s)

    @property
    def odd(self) -> tuple[str, ...]:
        """Faults of its source of landmarks, and of keeping pictures, so far, one line each."""
        return tuple(
            line for each in (self._source, self._kept) if each is not None for line in each.odd
        )

    @property
    def dropped(self) -> int:
        """Number of frames that a late reader missed or that were due before it began."""
        return self._waiting.dropped + self._missed

    @property
    def ending(self) -> Ending:
        """How far the video could be read; no frames until its end was reached."""
        return self._decoder.ending

    @property
    def over(self) -> bool:
        """True when the last frame was taken; for a damaged video `take` raises."""
        return self._waiting.over and self._failure is None

    def take(self, timeout_s: float) -> CapturedFrame | None:
        """The next frame; None when none came in time or the video is over.

        Raises:
            Undecodable: When the source has no picture.
            DecoderDied: When the decoder crashed, after the last valid frame.
            CameraLost: When a camera gives no more pictures.
        """
        frame = self._waiting.take(timeout_s)
        if frame is None and self._waiting.over and self._failure is not None:
            raise self._failure
        return frame

    def _run(self) -> None:
        """Deliver each frame at its time; in a thread of its own."""
        view = self._view
        wanted = Wanted(view.every(self._every), large=self._large(), quarters=view.quarters)
        frames = self._decoder.frames(view.source, view.size, wanted)
        try:
            for decoded in (each for each in frames if view.is_looked_at(each.index)):
                frame = self._timed(decoded)
                due_s = frame.clock_s - self._room.offset_s
                if not wait_until(due_s, self._stop, self._clock):
                    return
                if due_s < self._began_s:
                    self._missed += 1
                else:
                    self._waiting.put(self._with_landmarks(frame, decoded))
                    self._keep(decoded, frame.captured_s)
            if is_camera(view.source):
                raise CameraLost(view.source, self._decoder.ending.frames)
        except Exception as error:  # The reader raises whatever ended this thread,
            self._failure = None if self._stop.is_set() else error  # unless it has left.
        finally:
            frames.close()
            self._decoder.close()
            self._waiting.close()

    def _large(self) -> Size | None:
        """Size of a second picture of each frame, where one is needed."""
        asked = self._source.large if self._source else None
        whole = self._view.upright_source
        return whole if asked is None and self._kept and whole != self._view.size else asked

    def _keep(self, decoded: Decoded, captured_s: float) -> None:
        if self._kept is not None:
            large = decoded.large
            self._kept.take(decoded.picture if large is None else large, captured_s)

    def _with_landmarks(self, frame: CapturedFrame, decoded: Decoded) -> CapturedFrame:
        if self._source is None:
            return frame
        people = self._source.people(decoded, self._every / self._view.fps)
        return msgspec.structs.replace(frame, landmarks=people)

    def _timed(self, decoded: Decoded) -> CapturedFrame:
        if is_camera(self._view.source):
            now_s = decoded.grabbed_s + self._room.offset_s
            index = self._counted_from(now_s) + decoded.index
            captured_s, upright = now_s - self._view.late_s, self._view.upright
            return CapturedFrame(index, captured_s, now_s, decoded.picture, upright=upright)
        captured_s = self._view.captured_s(decoded.index)
        next_s = self._view.next_s(decoded.index, self._every)
        clock_s = self._room.start_s + captured_s
        return CapturedFrame(
            decoded.index, captured_s, clock_s, decoded.picture, next_s, upright=self._view.upright
        )

    def _counted_from(self, now_s: float) -> int:
        """Number of a camera's first frame: 0 at the run's start; after a restart the one for
        the present time, so that no number is used twice."""
        if self._first_index is None:
            since = max(0.0, now_s - self._room.start_s) * self._view.fps / self._every
            self._first_index = self._every * round(since)
        return self._first_index
