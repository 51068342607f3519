"""Videos of different rates: the faster one is sampled at the frames nearest to the slowest's."""

from typing import Final

import msgspec
import numpy as np

from common.body.body import Vector
from common.video.clip_facts import TOUCH_S, ClipView

SAME_RATE: Final = 0.01
"""Relative difference of frame rates that are treated as equal: they drift apart by less than a
frame in 100."""
SAME_VARYING: Final = 0.05
"""The same where a view's frames have times of their own, which pair them. The rate is then that
of the median gap, and times rounded to milliseconds give it no better (33 ms of 33.3)."""


def at_one_rate(views: tuple[ClipView, ...], every: int) -> tuple[ClipView, ...]:
    """The views of a clip, at the rate of the slowest.

    Without a partner frame the body would follow one view alone for a moment, again and again,
    which is less accurate than all views at a lower rate.

    Args:
        views: The views of the clip; live cameras are not resampled.
        every: Stride: every n-th frame of the slowest view is processed.
    """
    if len(views) < 2 or not all(view.known_frames for view in views):
        return views
    slow = min(views, key=lambda view: view.fps)
    return tuple(_meeting(view, slow, every) if _is_faster(view, slow) else view for view in views)


def _is_faster(view: ClipView, slow: ClipView) -> bool:
    varies = view.capture_s or slow.capture_s
    return view.fps / slow.fps - 1.0 > (SAME_VARYING if varies else SAME_RATE)


def _meeting(fast: ClipView, slow: ClipView, every: int) -> ClipView:
    """The faster view, with the frames nearest to those of the slower: each at most once, and
    none farther than half of its own period."""
    own_s, wanted_s = _times_s(fast), _times_s(slow)[::every]
    after = np.clip(np.searchsorted(own_s, wanted_s), 1, len(own_s) - 1)
    nearest = after - (wanted_s - own_s[after - 1] < own_s[after] - wanted_s)
    near = np.abs(own_s[nearest] - wanted_s) <= 0.5 / fast.fps + TOUCH_S
    picked = tuple(np.unique(nearest[near]).tolist())
    times_s = tuple((own_s + fast.late_s).tolist())
    return msgspec.structs.replace(fast, fps=slow.fps, capture_s=times_s, picked=picked)


def _times_s(view: ClipView) -> Vector:
    return np.array([view.captured_s(n) for n in range(view.known_frames)])
