"""Capture times of a video's frames: from its packets where the rate varies."""

from typing import Final

import msgspec
import numpy as np

from common.body.body import Vector
from common.video.pictures import VideoInfo

ROUNDED_S: Final = 0.002
"""Tolerance of times, seconds: Matroska rounds to milliseconds; a frame nearer to its place
keeps the rate."""
LAST_GAPS: Final = 2
"""Largest duration of the last frame, over the longest of the gaps before it."""


def timed(info: VideoInfo) -> VideoInfo:
    """The facts of a video with the times of its packets.

    Returns:
        Where the rate varies, `shown_s` has the time of each frame in their order, increasing from
        0, `fps` is the rate of the median gap, and `frames` says how many there are, or more if the
        film was cut off. Otherwise `shown_s` is empty: frames keep the rate, or packets tell no
        times that increase, as in an AVI whose frames refer to later ones.
    """
    # What an edit list hides has a time before 0, and is not decoded to a picture either.
    times = np.sort([moment for moment in info.shown_s if moment >= 0])
    gaps = np.diff(times)
    if not len(gaps) or not gaps.min() > 0:
        return msgspec.structs.replace(info, shown_s=())
    times -= times[0]
    if info.fps > 0 and _is_steady(times, info.fps):
        return msgspec.structs.replace(info, shown_s=())
    return msgspec.structs.replace(
        info,
        fps=float(1 / np.median(gaps)),
        frames=len(times) if _is_whole(times, gaps, info) else info.frames,
        shown_s=tuple(times.tolist()),
    )


def _is_steady(times: Vector, fps: float) -> bool:
    return bool(np.abs(times - np.arange(len(times)) / fps).max() <= ROUNDED_S)


def _is_whole(times: Vector, gaps: Vector, info: VideoInfo) -> bool:
    """Some files count their frames, others guess their number from their duration."""
    if len(times) >= info.frames:
        return True
    guessed_from_s = info.frames / max(info.fps, 1e-9)
    return bool(abs(guessed_from_s - times[-1]) <= LAST_GAPS * gaps.max())
