"""The number of an instant: the frame of camera 1 that was, or would have been, taken then."""

import math
from bisect import bisect_left
from typing import Final

import msgspec
import numpy as np

from common.video.clip_facts import Clip
from common.video.pictures import is_camera

NO_FRAME: Final = -1
"""Number of an instant at which camera 1 took no frame."""


class FrameTimes(msgspec.Struct, frozen=True):
    """When camera 1 takes its frames."""

    period_s: float
    """Time between two processed frames."""
    every: int = 1
    """Stride: every n-th frame of its video is processed."""
    counts: bool = False
    """True for a camera: its frames are counted as they come. The frames of a file have indices."""
    captured_s: tuple[float, ...] = ()
    """Capture times of a file's frames, where its rate varies or frames are missing."""


def frame_times(clip: Clip) -> FrameTimes | None:
    """The times of a clip's camera 1; None where that is no part of it."""
    view = clip.views[0]
    if view.number != 1:
        return None
    if view.picked:
        return FrameTimes(float(np.median(np.diff(view.capture_s))), captured_s=view.capture_s)
    return FrameTimes(clip.every / view.fps, clip.every, is_camera(view.source), view.capture_s)


def frame_at(times: FrameTimes, captured_s: float, before: int, before_s: float | None) -> int:
    """The number of an instant that camera 1's viewer does not report.

    It follows from time, not from reports: rows continue while a viewer is away.

    Args:
        times: When camera 1 takes frames.
        captured_s: Time of the instant.
        before: Number of the instant before; `before_s` is its time, None: there was none.

    Returns:
        NO_FRAME where its video has no frame within half a period of that time, or where the
        instant before has it already.
    """
    if times.counts:
        number = _counted(times, captured_s, before, before_s)
    elif times.captured_s:
        number = _placed(times, captured_s)
    else:
        number = times.every * _nearest(captured_s / times.period_s)
    return number if number > before else NO_FRAME


def _counted(times: FrameTimes, captured_s: float, before: int, before_s: float | None) -> int:
    if before_s is None:
        return 0
    since = _nearest((captured_s - before_s) / times.period_s)
    return before + times.every * max(1, since)


def _placed(times: FrameTimes, captured_s: float) -> int:
    taken_s, half_s = times.captured_s[:: times.every], times.period_s / 2
    place = bisect_left(taken_s, captured_s - half_s)
    if place == len(taken_s):
        beyond = _nearest((captured_s - taken_s[-1]) / times.period_s)
        return times.every * (place - 1 + beyond)
    near = min(taken_s[place : place + 2], key=lambda own_s: abs(own_s - captured_s))
    if abs(near - captured_s) > half_s:
        return NO_FRAME
    return times.every * (place + int(near != taken_s[place]))


def _nearest(value: float) -> int:
    """The nearest whole number, halves upwards: so numbers are consecutive at any shift."""
    return math.floor(value + 0.5)
