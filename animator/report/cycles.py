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
PROMINENT: Final = 0.4
"""Least height of a peak over the valleys beside it, in ranges of the motion."""
LEAST_DEG: Final = 12.0
"""Smallest range of a motion that has cycles, degrees along its main direction."""
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
    """The cycles of a run's main motion; none where it does not repeat itself.

    The main motion is the direction in which all angles together vary most; a cycle is from one
    extreme of it to the next, on the side where extremes are sharper. One that is much longer or
    shorter than the others, or has a gap, is left out.

    Args:
        angles_deg: (n, k), NaN where not known; an angle that is mostly not known is not used.
        time_s: (n,) increasing.
    """
    usable = np.isfinite(angles_deg).mean(axis=0) > 0.5
    known = np.asarray(np.isfinite(angles_deg[:, usable]).all(axis=1))
    if known.sum() < 8 or not usable.any():
        return NONE
    moved = angles_deg[known][:, usable]
    moved = moved - np.median(moved, axis=0)
    main = moved @ np.linalg.svd(moved, full_matrices=False)[2][0]
    own_s = time_s[known]
    step_s = float(np.median(np.diff(own_s)))
    calm = gaussian_filter1d(main, CALM_S / step_s)
    found = max((_of_peaks(way * calm, step_s) for way in (1.0, -1.0)), key=len)
    rows = np.flatnonzero(known)[found]
    return _alike(rows, known, time_s)


def _of_peaks(calm: Vector, step_s: float) -> NDArray[np.intp]:
    low, high = np.percentile(calm, [2, 98])
    if high - low < LEAST_DEG:
        return np.zeros(0, np.intp)
    apart = max(1, round(SHORTEST_S / step_s))
    peaks, _ = find_peaks(calm, prominence=PROMINENT * (high - low), distance=apart)
    return np.asarray(peaks, np.intp)


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
