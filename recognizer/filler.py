"""Models for a stream's other parts: how people stand, and how well a performance must fit."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from recognizer.features import Bearings

Array = NDArray[np.float64]

VARIANCE_FLOOR: Final = 0.01
"""Lower bound of an entry's variance, 6 degrees: as in the posture models."""
OPENING_POSES: Final = 3
"""Number of poses at a performance's start that show how people stand."""
NORMAL_MAD: Final = 1.4826
"""Standard deviation of a normal variable over its median absolute deviation."""


def standing(shown: Sequence[Sequence[Bearings]]) -> tuple[Array, Array]:
    """Mean and variance (27,) of standing people, from the sequences of all postures.

    Medians: a sequence that was cut in the middle of its motion does no harm.
    """
    opening = np.concatenate([one[:OPENING_POSES] for given in shown for one in given])
    mean = np.median(opening, axis=0)
    spread = NORMAL_MAD * np.median(np.abs(opening - mean), axis=0)
    return mean, np.maximum(np.square(spread), VARIANCE_FLOOR)


def fit_of(shown: Sequence[Bearings], mean: Array, variance: Array) -> float:
    """Median over sequences of the mean log density of a frame at its likeliest state.

    Args:
        shown: The sequences of one posture.
        mean: (s, 27) means of its states; `variance` alike.
    """
    level = np.log(2 * np.pi * variance).sum(axis=1)

    def fit(one: Bearings) -> float:
        apart = (np.square(one[:, np.newaxis] - mean) / variance).sum(axis=2)
        return float((-0.5 * (apart + level)).max(axis=1).mean())

    return float(np.median([fit(one) for one in shown]))
