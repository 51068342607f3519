"""Similarity of two silhouettes: the score that every search maximises, in plain numpy."""

import math

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
"""A silhouette: (height, width), True inside the person."""


def similarity(seen: Mask, drawn: Mask) -> float:
    """Area similarity of the silhouette that was seen and the model that was drawn.

    S = exp(-p - n) (1 - p), where p is the share of their union that only `seen` covers and n the
    share that only `drawn` covers. S is not symmetric: what the model misses costs more than what
    it adds. Two empty masks score 0: no person is there (P9). An empty `seen` scores exp(-1)
    whatever is drawn, so S alone never tells whether a person is present (M25).

    The kernel computes the same from packed bits and is tested against this function.

    Args:
        seen: (H, W) mask from the camera.
        drawn: (H, W) mask of the model, same shape.

    Returns:
        Score in [0, 1]; 1 where the masks coincide, 0 where the model covers nothing.

    Source: Huang & Chung 2004, section 2.3, eq. (1); Demir 2006, eqs. (3.1)-(3.3).
    """
    union = int(np.count_nonzero(seen | drawn))
    if union == 0:
        return 0.0
    p = int(np.count_nonzero(seen & ~drawn)) / union
    n = int(np.count_nonzero(drawn & ~seen)) / union
    return math.exp(-p - n) * (1.0 - p)
