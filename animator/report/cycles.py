"""Cycles of a motion: steps of a gait, repetitions of an exercise, found in a run's angles."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from common.body.body import Floats, Vector

CALM_S: Final = 0.12
"""Standard deviation of the smoothing before peaks are looked for, seconds."""
SHORTEST_S: Final = 0.4
"""Shortest cycle, seconds: nobody steps twice with one foot in less."""
PROMINENT: Final = 0.5
"""Least height of a peak over the valleys beside it, over that of most peaks."""
LEAST_DEG: Final = 12.0
"""Smallest height of a peak, degrees along the direction of the motion."""
DIRECTIONS: Final = 4
"""Number of main directions that are looked along."""
ALIKE: Final = 1.6
"""Largest ratio of a cycle's duration to the median one, and its inverse the smallest."""
FEWEST: Final = 2
POINTS: Final = 101
"""Places of a cycle, 0 to 100 %."""


class Cycles(NamedTuple):
    """The cycles of a motion."""

    spans: tuple[tuple[int, int], ...]
    """First row of each, and the row at which the next begins."""
    lasts_s: float
    """Median duration."""


NONE: Final = Cycles((), 0.0)


def cycles_of(angles_deg: Floats, time_s: Vector) -> Cycles:
    """The cycles of a run's motion; none where it does not repeat itself.

    The angles together vary along some main directions; that one counts along which most is
    repeated for the longest: arms that are lowered once may move further than all steps after
    that. A cycle is from one extreme to the next of its kind. One that is much longer or shorter
    than the others, or has a gap, is left out.

    Args:
        angles_deg: (n, k), NaN where not known; an angle that is mostly not known is not used.
        time_s: (n,) increasing; where it does not, there is no cycle.
    """
    usable = np.isfinite(angles_deg).sum(axis=0) > 0.5 * len(angles_deg)
    known = np.asarray(np.isfinite(angles_deg[:, usable]).all(axis=1))
    if known.sum() < 8 or not usable.any():
        return NONE
    moved = angles_deg[known][:, usable]
    moved = moved - np.median(moved, axis=0)
    step_s = float(np.median(np.diff(time_s[known])))
    if not step_s > 0:
        return NONE
    best, most = NONE, 0.0
    for direction in np.linalg.svd(moved, full_matrices=False)[2][:DIRECTIONS]:
        calm = gaussian_filter1d(moved @ direction, CALM_S / step_s)
        for way in (1.0, -1.0):
            peaks, high_deg = _peaks(way * calm, step_s)
            found = _alike(np.flatnonzero(known)[peaks], known, time_s)
            much = len(found.spans) * found.lasts_s * high_deg
            if much > most:
                best, most = found, much
    return best


def _peaks(calm: Vector, step_s: float) -> tuple[NDArray[np.intp], float]:
    """Rows of the extremes, and the median height of these over the valleys beside them.

    A peak counts that is as prominent as most, so that a single wide motion hides none.
    """
    apart = max(1, round(SHORTEST_S / step_s))
    peaks, told = find_peaks(calm, prominence=LEAST_DEG, distance=apart)
    if not len(peaks):
        return np.zeros(0, np.intp), 0.0
    usual_deg = float(np.median(told["prominences"]))
    return np.asarray(peaks[told["prominences"] >= PROMINENT * usual_deg], np.intp), usual_deg


def _alike(rows: NDArray[np.intp], known: NDArray[np.bool_], time_s: Vector) -> Cycles:
    lasts_s = np.diff(time_s[rows])
    if len(lasts_s) < FEWEST:
        return NONE
    usual_s = float(np.median(lasts_s))
    spans = tuple(
        (int(a), int(b))
        for a, b, long_s in zip(rows[:-1], rows[1:], lasts_s, strict=True)
        if usual_s / ALIKE <= long_s <= usual_s * ALIKE and known[a : b + 1].all()
    )
    return Cycles(spans, usual_s) if len(spans) >= FEWEST else NONE


def laid_over(values: Vector, cycles: Cycles, time_s: Vector) -> Floats:
    """A quantity of each cycle over its own course, (cycles, POINTS); NaN where not known."""
    courses = np.full((len(cycles.spans), POINTS), np.nan)
    for n, (a, b) in enumerate(cycles.spans):
        share = np.linspace(time_s[a], time_s[b], POINTS)
        courses[n] = np.interp(share, time_s[a : b + 1], values[a : b + 1])
    return courses
