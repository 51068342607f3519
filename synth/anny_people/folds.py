"""Waves over a surface: folds of cloth, locks of hair."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

WAVES: Final = 4
RATE: Final = (18.0, 75.0)
"""Range of their wave numbers, radians per metre."""


def folds(places_m: NDArray[np.float64], rng: np.random.Generator) -> Vector:
    """Heights of random waves at places (v, 3), (v,): most in [-1, 1], none beyond 2."""
    ways = rng.normal(0.0, 1.0, (WAVES, 3))
    ways *= rng.uniform(*RATE, (WAVES, 1)) / np.linalg.norm(ways, axis=1, keepdims=True)
    waves = np.sin(places_m @ ways.T + rng.uniform(0.0, 2 * np.pi, WAVES))
    return np.asarray(waves.mean(axis=1) * 2.0)
