"""The nearest row of some, for each row: what is known there holds where nothing is."""

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]


def nearest(rows: Rows, known: Rows) -> Rows:
    """For each of `rows` (n,) the nearest of `known` (k,), the earlier of two as near.

    Args:
        rows: Any.
        known: Increasing, at least one.
    """
    at = np.searchsorted(known, rows)
    before, after = known[(at - 1).clip(min=0)], known[at.clip(max=len(known) - 1)]
    return np.asarray(np.where(np.abs(rows - before) <= np.abs(after - rows), before, after))
