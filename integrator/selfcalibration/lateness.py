"""By how much one view is late, from how the person moves up and down in both."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, OTHER_SIDE
from integrator.selfcalibration.joint_tracks import JointTrack, at_times
from integrator.selfcalibration.sight_lines import Numbers

MOST_S: Final = 1.0
"""Views are not searched farther apart."""
FINE: Final = 2
"""Places between two frames that are tried."""
AS_GOOD: Final = 0.01
"""Correlations that differ by less say the same."""
SLOW_S: Final = 1.0
"""Whoever walks rises slowly in one picture and may sink in the other: means of so long are left
out. With them 7 of 43 made-up films of walks had clocks more than a frame off, by up to 35."""
LEAST_SHARED: Final = 15
"""Frames that both views must have, moved against each other."""
LEFT: Final = [n for n, name in enumerate(JOINT_NAMES) if name.startswith("l_")]
RIGHT: Final = OTHER_SIDE[LEFT]
MIDDLE: Final = [n for n, other in enumerate(OTHER_SIDE) if n == other]
LEAST_LATE: Final = 0.6
"""Share of a frame by which view 2 must be late before its clock is set."""


def likely_lateness_s(first: JointTrack, second: JointTrack) -> float:
    """How late the second view is, seconds; 0 where that is as likely as anything.

    What is up in the room is mostly up in any picture: the rows of the joints rise and fall
    together, wherever the cameras stand. Sides do not count.
    """
    period_s = float(np.median(np.diff(first.times_s))) if len(first.times_s) > 1 else 1.0
    shifts = np.arange(0.0, MOST_S, period_s / FINE)
    shifts = np.concatenate([-shifts[:0:-1], shifts])
    around = round(SLOW_S / period_s / 2)
    here = _quick(_rows(first), around)
    there = (at_times(second, first.times_s + s) for s in shifts)
    scores = np.array([_alike(here, _quick(_rows(track), around)) for track in there])
    best = int(np.argmax(scores))
    as_it_is = scores[len(shifts) // 2]
    return 0.0 if as_it_is >= scores[best] - AS_GOOD else float(shifts[best])


def _rows(track: JointTrack) -> Numbers:
    """(n, 15) rows of the middle joints, the middles of pairs and how far these are apart, pixels;
    NaN where somebody is not seen well."""
    rows = track.joints_px[..., 1].copy()
    rows[track.confidence < 0.1] = np.nan
    left, right = rows[:, LEFT], rows[:, RIGHT]
    return np.hstack([rows[:, MIDDLE], (left + right) / 2, np.abs(left - right)])


def _quick(rows: Numbers, around: int) -> Numbers:
    """The rows less their means over so many frames before and after each."""
    seen = np.isfinite(rows)
    sums = [_windowed(part, around) for part in (np.where(seen, rows, 0.0), seen.astype(float))]
    quick: Numbers = rows - sums[0] / np.maximum(sums[1], 1.0)
    return quick


def _windowed(values: Numbers, around: int) -> Numbers:
    """(n, k) sums over so many rows before and after each."""
    sums = np.pad(np.cumsum(values, axis=0), ((1, 0), (0, 0)))
    at = np.arange(len(values))
    windows: Numbers = sums[np.minimum(at + around, at[-1]) + 1] - sums[np.maximum(at - around, 0)]
    return windows


def _alike(one: Numbers, other: Numbers) -> float:
    """The correlation of all signals together, where both views have them, less where these are
    few; -1 where they have none."""
    shared = np.isfinite(one) & np.isfinite(other)
    enough = shared.sum(axis=0) >= LEAST_SHARED
    if not enough.any():
        return -1.0
    pairs = [_centred(signal, shared) for signal in (one, other)]
    sizes = [np.sqrt((signal**2).sum()) for signal in pairs]
    correlation = float((pairs[0] * pairs[1]).sum() / max(sizes[0] * sizes[1], 1e-9))
    return correlation * math.sqrt(float(shared.sum()) / max(float(np.isfinite(one).sum()), 1.0))


def _centred(signal: Numbers, shared: NDArray[np.bool_]) -> Numbers:
    kept = np.where(shared, signal, 0.0)
    mean = kept.sum(axis=0) / np.maximum(shared.sum(axis=0), 1)
    centred: Numbers = np.where(shared, signal - mean, 0.0)
    return centred
