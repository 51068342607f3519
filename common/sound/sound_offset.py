"""How late one sound is against another: by when sounds begin, not by what they sound like."""

import math
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from common.body.body import Floats, Vector

HOP_S: Final = 0.0025
"""Seconds between two points of an envelope."""
WINDOW_S: Final = 0.016
"""Length of sound that a point tells of."""
BANDS: Final = 6
"""Frequency bands whose onsets are added: a voice and a step share few of them."""
FLOOR: Final = 0.02
"""Energy that counts as silence, over the mean energy of a band."""
LEAST_S: Final = 1.0
"""Shortest sound that both must share."""
APART_S: Final = 0.05
"""Distance from a peak from which on another peak is another answer."""
CLEAR: Final = 8.0
"""Height of a peak over what is usual, in usual deviations, from which on it is no accident."""
ALONE: Final = 1.35
"""Ratio of a peak's height to that of the next answer: steps and music repeat themselves."""


class Heard(NamedTuple):
    """The delay of one sound against another."""

    late_s: float
    """What the first has at t, the second has at t + late_s."""
    is_clear: bool
    """False: something else explains them as well, or nothing does."""


def delay_of(first: Vector, second: Vector, rate_hz: int, most_s: float) -> Heard:
    """The delay of the second sound.

    Args:
        first: (n,) samples.
        second: (m,) samples.
        rate_hz: Their rate.
        most_s: Largest delay, of either sign.
    """
    one, other = onsets(first, rate_hz), onsets(second, rate_hz)
    least = round(LEAST_S / HOP_S)
    if min(len(one), len(other)) < least or not (one.any() and other.any()):
        return Heard(0.0, False)
    likeness, lags = _likeness(one, other, least)
    near = np.abs(lags) <= most_s / HOP_S
    likeness, lags = likeness[near], lags[near]
    at = int(np.argmax(likeness))
    usual = float(np.median(likeness))
    deviation = 1.4826 * float(np.median(np.abs(likeness - usual))) + 1e-12
    rest = likeness[np.abs(lags - lags[at]) > APART_S / HOP_S]
    peak, second_peak = likeness[at] - usual, float(rest.max(initial=usual)) - usual
    is_clear = peak > CLEAR * deviation and peak > ALONE * second_peak
    return Heard(HOP_S * (float(lags[at]) + _between(likeness, at)), bool(is_clear))


def onsets(sound: Vector, rate_hz: int) -> Vector:
    """How much louder a sound becomes, (k,) every HOP_S: the rise of the logarithm, by band."""
    hop, window = round(HOP_S * rate_hz), round(WINDOW_S * rate_hz)
    count = (len(sound) - window) // hop + 1
    if count < 2:
        return np.zeros(0)
    rows = np.lib.stride_tricks.sliding_window_view(sound, window)[::hop][:count]
    power = np.abs(np.fft.rfft(rows * np.hanning(window), axis=1))[:, 1:] ** 2
    edges = np.geomspace(1, power.shape[1], BANDS + 1).round().astype(int)
    parts = [power[:, a - 1 : max(b, a + 1) - 1].sum(axis=1) for a, b in pairwise(edges)]
    energy: Floats = np.stack(parts, axis=1)
    level = np.log(energy + FLOOR * energy.mean(axis=0) + 1e-20)
    rise = np.maximum(np.diff(level, axis=0), 0.0).sum(axis=1)
    return np.asarray(rise - rise.mean())


def _likeness(one: Vector, other: Vector, least: int) -> tuple[Vector, Vector]:
    """Correlation at each delay at which both share enough, and the delays in hops."""
    size = 1 << math.ceil(math.log2(len(one) + len(other)))
    turned = np.conj(np.fft.rfft(one, size))
    whole = np.fft.irfft(turned * np.fft.rfft(other, size), size)
    lags = np.arange(-(len(one) - least), len(other) - least + 1)
    shared = np.minimum(len(one), len(other) - lags) - np.maximum(0, -lags)
    return whole[lags] / np.sqrt(shared), lags.astype(np.float64)


def _between(values: Vector, at: int) -> float:
    """Where a parabola through a peak and its neighbours is highest, from the peak."""
    if not 0 < at < len(values) - 1:
        return 0.0
    before, here, after = values[at - 1 : at + 2]
    bend = before - 2.0 * here + after
    return 0.5 * float(before - after) / float(bend) if bend < 0.0 else 0.0
