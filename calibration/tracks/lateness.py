"""The delay of view 2, from both views of the person, whatever the cameras are.

At one instant both views of a point satisfy one relation (`view_relation.py`). It is fitted for
each delay that leaves the clips enough in common; the delay that explains most is the likeliest.
Its relation then tests which other delays explain their pairs nearly as well. In long clips the
relation is fitted only where both views move alike (`moving_alike.py`), and at a few evenly spread
delays.
"""

from itertools import chain, pairwise
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.joint_tracks import (
    LEAST_SURE,
    JointTrack,
    Sighting,
    height_px,
    smoothed,
)
from calibration.tracks.late_fit import LEAST_SHARED, SURE, Fit, fits_of
from calibration.tracks.moving_alike import promising

MOMENTS: Final = 120
"""Number of moments of view 1, evenly spread, that delays are fitted to."""
STEP_S: Final = 0.07
"""Step of the first search, seconds; a frame, where that is longer."""
MOST_TRIED: Final = 900
"""Number of delays above which only the promising ones are fitted: both views last more than
half a minute."""
NEAR_BEST_S: Final = 1.0
"""Distance from the best of the promising delays, seconds, within which all are fitted too."""
FINE_FRAMES: Final = np.arange(-6, 7) / 4
"""Offsets from the likeliest delay, frames, that the last search fits."""
SHARED_S: Final = 2.0
"""Least time that both views must have in common, seconds, for a delay to be reported."""
AS_GOOD, SURE_AS_GOOD = 1.2, 1.4
"""Ratio of a delay's misses to those of the likeliest, up to which it may be the right one.
SURE_AS_GOOD is for landmarks that err much and a delay that would change the times, AS_GOOD for
the times as they are."""
CLEAR: Final = 0.2
"""Misses of the likeliest delay up to which landmarks count as accurate: 0.06 to 0.15 in walks
of two performers, 0.3 and more in synthetic ones (docs/measurements.md)."""
AS_MUCH: Final = 1.0 / 3.0
"""Least share of the moments that the likeliest delay must explain for landmarks to count as
accurate. Chosen with AS_GOOD and CLEAR on walks of two performers at offsets of -3 to 3 s, and
on synthetic ones (docs/measurements.md)."""
ONE_S, WIDE_S = 0.25, 0.45
"""Difference of two delays, seconds, below which they count as one, since no person steps
faster; WIDE_S where all between them fit as well, because a slow walk determines time less
exactly."""
LEAST_LATE: Final = 0.6
"""Smallest delay of view 2, frames, that is corrected."""


class Clock(NamedTuple):
    """Delay of view 2: what view 1 shows at t, view 2 shows at t + late_s of its own times."""

    late_s: float
    """The likeliest delay."""
    rivals_s: tuple[float, ...] | None = ()
    """Other delays that explain as much: a gait repeats itself, and a standing person shows no
    time. None: nothing is known."""
    may_be_on_time: bool = True
    """The times as they are remain possible."""

    @property
    def state(self) -> Literal["found", "ambiguous", "unknown"]:
        """The result in a word: found, ambiguous, or unknown."""
        return "unknown" if self.rivals_s is None else "ambiguous" if self.rivals_s else "found"

    @property
    def is_found(self) -> bool:
        """No other delay explains as much."""
        return self.rivals_s == ()


UNSEEN: Final = Clock(0.0, None)
"""The result where both views show too little of a person."""


def clock_of(sighting: Sighting) -> Clock:
    """The delay of view 2, as far as both views determine it."""
    views = _prepared(sighting)
    runs = _searched(views, sighting) if views else []
    if not views or not runs:
        return UNSEEN
    fits = list(chain(*runs))
    best = _likeliest(fits)
    period_s = float(np.median(np.diff(views[1].times_s)))
    near = fits_of(views, (best.late_s + period_s * FINE_FRAMES).tolist())
    finest = min(near, key=lambda fit: fit.miss)
    apart_s = float(np.median(np.diff(views[0].times_s)))
    if finest.moments * apart_s < SHARED_S:
        return UNSEEN
    on_time = any(fit.late_s == 0.0 and _ratio(fit, finest) <= SURE_AS_GOOD for fit in fits)
    is_sure = finest.miss <= CLEAR or abs(finest.late_s) <= period_s
    as_good = AS_GOOD if is_sure else SURE_AS_GOOD
    rivals_s = tuple(chain(*(_rivals(finest, run, as_good) for run in runs)))
    if rivals_s and on_time and min(map(abs, (finest.late_s, *rivals_s))) > ONE_S:
        rivals_s = (*rivals_s, 0.0)
    return Clock(finest.late_s, rivals_s, on_time)


def miss_at(sighting: Sighting, late_s: float) -> float | None:
    """Mean miss of the relation between both views' pictures at a delay of view 2; None where both
    show too little."""
    views = _prepared(sighting)
    fits = fits_of(views, [late_s]) if views else []
    return fits[0].miss if fits else None


def _prepared(sighting: Sighting) -> tuple[JointTrack, JointTrack] | None:
    """View 1 at the moments used, and view 2, in heights about their middles."""
    sure = np.flatnonzero(sighting.first.confidence.mean(axis=1) >= LEAST_SURE)
    if len(sure) < LEAST_SHARED or len(sighting.second.times_s) < LEAST_SHARED:
        return None
    units = height_px(sighting.first), height_px(sighting.second)
    if not all(units):
        return None
    picked = np.linspace(0, len(sure) - 1, min(MOMENTS, len(sure))).astype(int)
    first, second = (
        _in_heights(smoothed(track), unit)
        for track, unit in zip((sighting.first, sighting.second), units, strict=True)
    )
    return JointTrack(*(part[sure[picked]] for part in first)), second


def _in_heights(track: JointTrack, unit_px: float) -> JointTrack:
    middle_px = track.joints_px[track.confidence >= SURE].mean(axis=0)
    return track._replace(joints_px=(track.joints_px - middle_px) / unit_px)


def _searched(views: tuple[JointTrack, JointTrack], sighting: Sighting) -> list[list[Fit]]:
    """The delays to try, in runs of equal steps."""
    step_s = max(STEP_S, float(np.median(np.diff(views[1].times_s))))
    steps = tried = _steps(*views, step_s)
    if len(steps) > MOST_TRIED:
        tried = promising(sighting.first, sighting.second, steps, step_s)
    fits = fits_of(views, (step_s * tried).tolist())
    if not fits:
        return []
    is_near = np.abs(step_s * steps - _likeliest(fits).late_s) <= NEAR_BEST_S
    more = np.setdiff1d(steps[is_near], tried)
    fits = sorted(fits + fits_of(views, (step_s * more).tolist()), key=lambda fit: fit.late_s)
    tried = np.union1d(tried, more)
    begins = step_s * tried[1:][np.diff(tried) > 1]
    cuts = np.searchsorted([fit.late_s for fit in fits], begins).tolist()
    runs = [fits[begin:end] for begin, end in pairwise((0, *cuts, len(fits)))]
    return [run for run in runs if run]


def _steps(first: JointTrack, second: JointTrack, step_s: float) -> NDArray[np.int64]:
    """All delays that may leave enough in common; 0 is among them."""
    low = int((second.times_s[0] - first.times_s[-1]) / step_s)
    high = int((second.times_s[-1] - first.times_s[0]) / step_s)
    return np.arange(low, high + 1)


def _likeliest(fits: list[Fit]) -> Fit:
    usual = float(np.median([fit.miss for fit in fits]))
    return max(fits, key=lambda fit: fit.weights.sum() * (usual - fit.miss))


def _rivals(best: Fit, fits: list[Fit], as_good: float) -> tuple[float, ...]:
    """One of each stretch of delays that are as good as the best, by their pairs."""
    ratios = np.array([_ratio(fit, best) for fit in fits])
    late_s = np.array([fit.late_s for fit in fits])
    enough = np.array([fit.moments >= AS_MUCH * best.moments for fit in fits])
    close, off_s = enough & (ratios <= as_good), np.abs(late_s - best.late_s)
    stretches = np.split(np.arange(len(fits)), np.flatnonzero(np.diff(close)) + 1)
    rivals = []
    for each in (each for each in stretches if close[each[0]]):
        far = each[off_s[each] > (WIDE_S if off_s[each].min() < ONE_S / 2 else ONE_S)]
        rivals += [far[np.argmin(ratios[far])]] if len(far) else []
    return tuple(late_s[rivals].tolist())


def _ratio(fit: Fit, best: Fit) -> float:
    """Ratio of one delay's misses to the best's, at moments that both have where these are
    enough."""
    both = (fit.weights > 0) & (best.weights > 0)
    if both.sum() < LEAST_SHARED:
        return fit.miss / best.miss
    one, other = (each.costs[both].sum() / each.weights[both].sum() for each in (fit, best))
    return float(one / max(other, 1e-9))
