"""The pictures of a clip's views: their backgrounds, then those of one instant together."""

import threading
from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from typing import Final

from common.bus.messages import ViewerNumber
from common.config.part_settings import SilhouetteSettings
from common.video.clip_facts import Clip, ClipView
from common.video.pictures import ALL, Decoded, Ending, Reader, Size, Source, Wanted
from integrator.pairing import are_together
from viewer.capture import recorded
from viewer.captured_frame import CapturedFrame
from viewer.landmarks.landmark_sources import Sources
from viewer.room.background_source import Opening, opening_of_view

Readers = Mapping[ViewerNumber, Reader]
"""The reader of each view, by number."""
NONE: Final[Mapping[ViewerNumber, int]] = {}


class _UntilLeft:
    """A reader that stops once its result is not needed any more."""

    def __init__(self, reader: Reader, left: threading.Event) -> None:
        self._reader, self._left = reader, left

    @property
    def ending(self) -> Ending:
        """As the reader's."""
        return self._reader.ending

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        """As the reader's.

        Raises:
            CancelledError: When the result is not needed any more.
        """
        for decoded in self._reader.frames(source, size, wanted):
            if self._left.is_set():
                raise CancelledError
            yield decoded


def openings(clip: Clip, settings: SilhouetteSettings, readers: Readers) -> list[Opening]:
    """The backgrounds of all views before the first frame, learnt in parallel.

    Most of the time is spent on decoding. An interruption by Ctrl-C, or an unreadable view, does
    not wait for the other views.
    """
    left = threading.Event()

    def learnt(view: ClipView) -> Opening:
        return opening_of_view(view, settings, _UntilLeft(readers[view.number], left))

    with ThreadPoolExecutor(len(clip.views)) as pool:
        try:
            return [*pool.map(learnt, clip.views)]
        except BaseException:
            left.set()
            raise


def share_of(clip: Clip, frames: Mapping[ViewerNumber, CapturedFrame]) -> float:
    """Share of a clip up to the frames of an instant; 0 for a camera, which has no end."""
    lengths = {view.number: view.frames for view in clip.views}
    shares = [(one.index + 1) / lengths[n] for n, one in frames.items() if lengths[n]]
    return min(1.0, max(shares, default=0.0))


def instants(
    clip: Clip, readers: Readers, sources: Sources, starts: Mapping[ViewerNumber, int] = NONE
) -> Iterator[dict[ViewerNumber, CapturedFrame]]:
    """The frames of all views, those of one instant together, in the order of time.

    Args:
        clip: The clip of the views.
        readers: Reader of each view.
        sources: Source of each view's landmarks.
        starts: First frame of each view, where it is not 0.
    """
    streams = {
        n: recorded(view, clip.every, readers[n], sources.get(n), starts.get(n, 0))
        for n, view in ((view.number, view) for view in clip.views)
    }
    waiting = {number: next(stream, None) for number, stream in streams.items()}
    period_s = clip.every / clip.views[0].fps
    while due := [frame for frame in waiting.values() if frame is not None]:
        first = min(due, key=lambda frame: frame.captured_s)
        now: dict[ViewerNumber, CapturedFrame] = {}
        for number, frame in waiting.items():
            if frame is first or (frame is not None and are_together(first, frame, period_s)):
                now[number] = frame
                waiting[number] = next(streams[number], None)
        yield now
