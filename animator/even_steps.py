"""Rows of a run on even steps of time, as every file of motion wants them."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.skeleton.bones import Joints
from common.body.body import Vector

MOST_FRAMES: Final = 1_000_000
"""Longer files are a mistake in the times: a gap that is filled has no end."""
WHOLE: Final = 0.4
"""Times of rows are so near to whole frames, in frames; another rate for a while is not."""


class NoMotion(ValueError):
    """There is nothing to animate: the text says why."""


class EvenSteps(NamedTuple):
    """Where the poses of a run stand in a file of even steps that begins with the first of them."""

    posed: NDArray[np.intp]
    """(k,) rows of the run that have a pose."""
    places: NDArray[np.int64]
    """(k,) the file's frame of each; two rows can share one."""
    step_s: float

    @property
    def frames(self) -> int:
        """Of the file, from the first pose to the last."""
        return int(self.places[-1]) + 1


def even_steps(joints_m: Joints, time_s: Vector) -> EvenSteps:
    """Lay a run out in even steps.

    Args:
        joints_m: (n, joints, 3), NaN where there is no pose.
        time_s: (n,) of the rows.

    Raises:
        NoMotion: When there are no two poses, or the times make no even steps.
    """
    posed = np.flatnonzero(np.isfinite(joints_m).all(axis=(1, 2)))
    if len(posed) < 2:
        raise NoMotion(f"{len(posed)} frames have a pose, an animation needs two")
    if not (np.isfinite(time_s).all() and (np.diff(time_s) > 0).all()):
        raise NoMotion("the times of the frames do not increase")
    step_s = _step_s(time_s)
    places = np.rint((time_s[posed] - time_s[posed[0]]) / step_s).astype(np.int64)
    if places[-1] >= MOST_FRAMES:
        raise NoMotion(f"it would have {places[-1] + 1} frames, at most {MOST_FRAMES} are written")
    return EvenSteps(posed, places, step_s)


def _step_s(time_s: Vector) -> float:
    """Of a frame: the mean over all rows that are one or two apart.

    Their median alone drifts by frames: of times in whole milliseconds it is one itself.
    """
    steps_s = np.diff(time_s)
    apart = steps_s / np.percentile(steps_s, 50, method="lower")
    frames = np.rint(apart)
    near = (np.abs(apart - frames) <= WHOLE) & (frames >= 1) & (frames <= 2)
    return float(steps_s[near].sum() / frames[near].sum())


def with_gaps(joints_m: Joints, steps: EvenSteps) -> Joints:
    """The joints as the file's frames have them; NaN where nothing was seen."""
    rows = np.full((steps.frames, *joints_m.shape[1:]), np.nan)
    keys, first = np.unique(steps.places, return_index=True)
    rows[keys] = joints_m[steps.posed[first]]
    return rows
