"""A joint's spread and its confidence: each tells the other."""

import math
from typing import Final

import numpy as np

from common.body.body import Floats

FIRM_M: Final = 0.02
PLATT: Final = (2.15, 4.25)
"""Platt scaling of a joint's confidence: its logit at a standard deviation of FIRM_M, and the fall
where the deviation grows e-fold. Fitted to joints less than 50 mm off (docs/measurements.md)."""
LEAST: Final = 0.02
"""Confidence below which a spread says no more: the joint may be anywhere on the body."""
MOST: Final = 0.995


def confidence_of(spread_m: Floats) -> Floats:
    """Probability that joints are less than 50 mm off, by the standard deviation of a coordinate
    that the fusion's covariance gives them."""
    certain, steep = PLATT
    found: Floats = 1.0 / (1.0 + np.exp(-certain) * (spread_m / FIRM_M) ** steep)
    return found


def spread_of(confidence: Floats) -> Floats:
    """The inverse: standard deviation of a coordinate, metres, by the confidence."""
    certain, steep = PLATT
    sure = np.clip(confidence, LEAST, MOST)
    found: Floats = FIRM_M * (math.exp(certain) * (1.0 / sure - 1.0)) ** (1.0 / steep)
    return found
