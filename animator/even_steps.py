"""Rows of a run at even time steps, as motion files require."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from animator.skeleton.bones import Joints
from common.body.body import Vector

MOST_FRAMES: Final = 1_000_000
"""Largest number of frames: a longer file means wrong times, as gaps are filled."""
WHOLE: Final = 0.4
"""Deviation from a whole number of frames, in frames, up to which a step counts for the rate."""
TREMBLES: Final = 0.25
"""Deviation from whole frames, in frames, up to which rows are moved to them: clocks jitter, and
many cameras round to milliseconds."""
AROUND: Final = 9
"""Number of steps whose median gives the rate of a stretch."""
FASTEST: Final = 10
"""Where the rate varies, the file's step is this percentile of all stretches': low, so that no
row of the fastest stretches is skipped."""
USUAL: Final = 1.5
"""Distance of two rows, in median steps, from which on a row between them was lost."""


class NoMotion(ValueError):
    """Nothing to animate: the text says why."""


class EvenSteps(NamedTuple):
    """Places of a run's poses in a file of even steps that begins with the first of them."""

    posed: NDArray[np.intp]
    """(k,) rows of the run that have a pose."""
    places: Vector
    """(k,) the place of each among the file's frames, increasing: whole numbers at an even rate,
    fractions where the rate varies."""
    seen: NDArray[np.bool_]
    """(frames,) whether a pose is there, or on both sides without a gap between them."""
    step_s: float

    @property
    def frames(self) -> int:
        """Time step of the file."""
        return len(self.seen)

    def nearest(self) -> NDArray[np.intp]:
        """(frames,) the row whose pose is nearest to each frame of the file."""
        at = np.interp(np.arange(self.frames), self.places, np.arange(len(self.places)))
        return np.asarray(self.posed[np.rint(at).astype(np.intp)])


def even_steps(joints_m: Joints, time_s: Vector) -> EvenSteps:
    """Resample a run to even steps.

    Args:
        joints_m: (n, joints, 3), NaN where there is no pose.
        time_s: (n,) times of the rows.

    Raises:
        NoMotion: When there are fewer than two poses, or the times do not increase.
    """
    posed = np.flatnonzero(np.isfinite(joints_m).all(axis=(1, 2)))
    if len(posed) < 2:
        raise NoMotion(f"{len(posed)} frames have a pose, an animation needs two")
    if not (np.isfinite(time_s).all() and (np.diff(time_s) > 0).all()):
        raise NoMotion("the times of the frames do not increase")
    step_s, places = _laid(time_s, posed)
    if places[-1] >= MOST_FRAMES:
        raise NoMotion(
            f"it would have {places[-1] + 1:.0f} frames, at most {MOST_FRAMES} are written"
        )
    return EvenSteps(posed, places, _seen(time_s, posed, places), step_s)


def _laid(time_s: Vector, posed: NDArray[np.intp]) -> tuple[float, Vector]:
    """Seconds per frame, and the poses' places among the file's frames."""
    steps_s = np.diff(time_s)
    apart = np.maximum(1.0, np.rint(steps_s / _usual_step_s(steps_s)))
    frames = np.append(0.0, np.cumsum(apart))
    step_s, first_s = np.polyfit(frames, time_s, 1)
    if (np.abs(time_s - first_s - step_s * frames)[posed] <= TREMBLES * step_s).all():
        return float(step_s), frames[posed] - frames[posed[0]]
    step_s = np.percentile(uniform_filter1d(steps_s, AROUND, mode="nearest"), FASTEST)
    return float(step_s), (time_s[posed] - time_s[posed[0]]) / step_s


def _usual_step_s(steps_s: Vector) -> float:
    """Time per frame: the mean over all rows that are one or two apart.

    The median alone would drift by whole frames: of times in whole milliseconds it is a whole
    millisecond too.
    """
    apart = steps_s / np.percentile(steps_s, 50, method="lower")
    frames = np.rint(apart)
    near = (np.abs(apart - frames) <= WHOLE) & (frames >= 1) & (frames <= 2)
    return float(steps_s[near].sum() / frames[near].sum())


def _seen(time_s: Vector, posed: NDArray[np.intp], places: Vector) -> NDArray[np.bool_]:
    """For each frame of the file, whether it lies on a pose, or between two neighbouring ones."""
    steps_s = np.diff(time_s)
    usual_s = median_filter(steps_s, AROUND, mode="nearest")
    together = (steps_s <= USUAL * usual_s)[posed[:-1]] & (np.diff(posed) == 1)
    frames = np.arange(int(places[-1] + 1e-6) + 1)
    before = np.searchsorted(places, frames + 1e-6) - 1
    on_a_pose = np.abs(frames - places[before]) < 1e-6
    return np.asarray(on_a_pose | np.append(together, False)[before])


def with_gaps(joints_m: Joints, steps: EvenSteps) -> Joints:
    """The joints at the file's frames; NaN where no pose is known."""
    rows = np.full((steps.frames, *joints_m.shape[1:]), np.nan)
    keys = np.flatnonzero(steps.seen)
    before = np.clip(np.searchsorted(steps.places, keys, "right") - 1, 0, len(steps.places) - 2)
    ahead = (keys - steps.places[before]) / np.diff(steps.places)[before]
    start, end = joints_m[steps.posed[before]], joints_m[steps.posed[before + 1]]
    share = np.clip(ahead, 0.0, 1.0)[:, None, None]
    rows[keys] = np.where(share == 1.0, end, start + share * (end - start))
    return rows
