"""Speed of tracking one camera's clip, from its video to poses, with a known background."""

import time
from collections.abc import Iterator
from typing import Final, NamedTuple

import cv2

from common.config.settings import Settings
from common.method import METHODS, Mode
from common.video.clips import open_clip
from common.video.decoding import Decoder
from lab.bench.bench_figure import Measured, least_s
from runtime.offline.video_passes import VideoFacts, bodies_of, silhouettes_of
from runtime.offline.video_tracking import VideoInput, follow_clip
from runtime.steps.frame_cache import FrameCache
from viewer.room.background_source import background_of_film

ALONE: Final = (1,)
"""The view that is tracked."""
FOLLOWED: Final[tuple[tuple[Mode, str, float], ...]] = (
    ("default", "320x240", 200.0),
    ("thesis", "320x240", 200.0),
)
"""Modes and sizes in which it is tracked, and the required frames per second."""


class Times(NamedTuple):
    """Minimum seconds of several runs over all frames: wall time for the decoder, which is a
    separate process, and processor time of this process for the rest."""

    frames: int
    decoding_s: float
    silhouettes_s: float
    poses_s: float

    @property
    def frames_a_second(self) -> float:
        """One stage after the other on one core; learning the background does not count."""
        return self.frames / (self.decoding_s + self.silhouettes_s + self.poses_s)


def figures(settings: Settings, repeats: int, target: float) -> Iterator[Measured]:
    """The frame rate, and each part's time."""
    at, found = f"{settings.mode}, {settings.size}", followed(settings, repeats)
    yield Measured(f"single, video to poses, {at}", found.frames_a_second, "frames/s", target)
    for what, value_ms in parts_ms(found).items():
        yield Measured(f"- {what}, {at}", value_ms, "ms a frame")


def parts_ms(found: Times) -> dict[str, float]:
    """Time of each stage per frame."""
    parts_s = (found.decoding_s, found.silhouettes_s, found.poses_s)
    names = ("decoding of one view", "silhouettes of one view", "poses of one view")
    return {name: 1e3 * part_s / found.frames for name, part_s in zip(names, parts_s, strict=True)}


def followed(settings: Settings, repeats: int) -> Times:
    """Track a clip's first camera repeatedly, as `tritrack single` does without calibration.

    Args:
        settings: They name the clip, the mode and the size of the working picture.
        repeats: Number of measured runs, after a first one that may compile.

    Raises:
        ClipError: When there is no such clip.
        Undecodable, DecoderDied: When it has no pictures.
    """
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with Decoder() as decoder:
            return _followed(settings, repeats, decoder)
    finally:
        cv2.setNumThreads(threads)


def _followed(settings: Settings, repeats: int, decoder: Decoder) -> Times:
    clip = open_clip(settings, decoder, ALONE)
    view, frame_cache = clip.views[0], FrameCache(decoder)
    background = background_of_film(view, settings.silhouette, frame_cache)
    method, period_s = METHODS[settings.mode], clip.every / view.fps
    followed = follow_clip(VideoInput(clip, background), settings, method, decoder)
    film = VideoFacts(settings, method, view.number, period_s, None)

    def decoded() -> int:
        return sum(1 for _ in decoder.frames(view.source, view.size))

    def cut_out() -> int:
        return len(silhouettes_of(clip, background, film, frame_cache))

    def posed() -> int:
        return len(bodies_of(followed.reports, film).bodies)

    return Times(
        len(followed.reports),
        least_s(decoded, repeats),
        least_s(cut_out, repeats, time.process_time),
        least_s(posed, repeats, time.process_time),
    )
