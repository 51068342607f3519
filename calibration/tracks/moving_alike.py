"""Delays at which both views move alike: a fast first search of long clips.

Both views' motions of a person are correlated at the right delay, whatever the cameras are. The
Fourier transform gives this correlation at every delay for the price of a few.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.joint_tracks import JOINTS, LEAST_SURE, JointTrack, at_times
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector

PEAKS: Final = 120
"""Number of best-correlated delays that are fitted. In synthetic walks of one to three minutes
the true one is among the first 20, where a person moves at random among the first 110
(docs/measurements.md)."""
AROUND: Final = np.arange(-1, 2)
"""Neighbours of each that are fitted too, as for 0 and the clip's own."""
EVENLY: Final = 150
"""Number of evenly spread delays that are fitted as well: they show what fits by chance."""
LEAST_SHARE: Final = 0.1
"""Share of view 1's moments that view 2 must show too: few moments correlate with anything."""
Steps = NDArray[np.int64]
"""(n,) delays of view 2, in steps."""


def promising(first: JointTrack, second: JointTrack, steps: Steps, step_s: float) -> Steps:
    """The promising ones among successive `steps` of that many seconds, increasing."""
    scores = alike(first, second, steps, step_s)
    middle = scores[1:-1]
    peaks = 1 + np.flatnonzero((middle >= scores[:-2]) & (middle > scores[2:]))
    highest = peaks[np.argsort(scores[peaks])[-PEAKS:]]
    near = np.append(highest, np.flatnonzero(steps == 0))[:, None] + AROUND
    evenly = np.linspace(0, len(steps) - 1, EVENLY).astype(int)
    return steps[np.union1d(near.clip(0, len(steps) - 1), evenly)]


def alike(first: JointTrack, second: JointTrack, steps: Steps, step_s: float) -> Vector:
    """(n,) how significantly both views move alike at each delay (n,).

    The largest canonical correlation of a landmark's two coordinates in either view, about its mean
    place, times the square root of the number of pairs; 0 where these are too few.
    """
    (begin_1, one), (begin_2, other) = (_at_steps(track, step_s) for track in (first, second))
    length = 1 << (len(one) + len(other)).bit_length()
    products, pairs = np.zeros((length, 2, 2)), np.zeros(length)
    for n in range(JOINTS):
        ours, theirs = (np.fft.rfft(view[:, n], length, axis=0) for view in (one, other))
        mixed = ours[:, :, None].conj() * theirs[:, None]
        products += np.fft.irfft(mixed[:, :2, :2], length, axis=0)
        pairs += np.fft.irfft(mixed[:, 2, 2], length)
    whiten_1, whiten_2 = _whiten(one), _whiten(other)
    places = steps - (begin_2 - begin_1)
    inside = (places > -len(one)) & (places < len(other))
    places = np.where(inside, places, 0) % length
    sums = np.linalg.norm(whiten_1.T @ products[places] @ whiten_2, ord=2, axis=(1, 2))
    enough = inside & (pairs[places] > LEAST_SHARE * np.count_nonzero(one[..., 2]))
    score: Vector = np.where(enough, sums / np.sqrt(np.maximum(pairs[places], 1.0)), 0.0)
    return score


def _at_steps(track: JointTrack, step_s: float) -> tuple[int, Numbers]:
    """The first step; (n, 15, 3) places about a landmark's mean, weighted, and whether seen."""
    begin, end = (int(np.ceil(track.times_s[n] / step_s)) for n in (0, -1))
    shown = at_times(track, step_s * np.arange(begin, end, dtype=np.float64))
    weights = shown.confidence * (shown.confidence.mean(axis=1) >= LEAST_SURE)[:, None]
    total = np.maximum(weights.sum(axis=0), 1e-9)[:, None]
    means = (weights[..., None] * shown.joints_px).sum(axis=0) / total
    around = weights[..., None] * (shown.joints_px - means)
    return begin, np.concatenate([around, (weights > 0)[..., None]], axis=-1)


def _whiten(view: Numbers) -> Numbers:
    """(2, 2) whitening matrix: both coordinates get variance 1 and no correlation."""
    flat = view[..., :2].reshape(-1, 2)
    spread = flat.T @ flat + 1e-9 * np.eye(2)
    root: Numbers = np.linalg.cholesky(np.linalg.inv(spread))
    return root
