"""How tall a person would stand in every frame of a clip: the scale of a single view (T20)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.raster.similarity import Mask

MIDDLE_SHARE: Final = 0.05
"""Half the width, in heights, of the column in which the head is looked for: raised arms pass."""
UPRIGHT: Final = 0.75
"""Of the heights of a clip, the one that so many stay below: most of them stand, few jump."""
NEARER: Final = 0.15
"""Feet that move by this share of the height tell that the person comes nearer."""
MOST_SAMPLES: Final = 300
"""So many heights tell the slope."""


def standing_rows(mask: Mask) -> tuple[float, float]:
    """Row of the crown over the middle of a silhouette, and row below its feet, pixels."""
    rows, columns = np.nonzero(mask)
    bottom = int(rows.max()) + 1
    half = max(1.0, MIDDLE_SHARE * (bottom - int(rows.min())))
    middle = np.abs(columns - np.median(columns)) <= half
    return float(rows[middle].min()), float(bottom)


def statures_px(crowns: Vector, soles: Vector, whole: NDArray[np.bool_]) -> Vector:
    """Height of the person standing upright, at the place of each frame, (n,) pixels.

    One height of the clip holds for all frames, not each frame's own: a squat would shrink it.
    Where the feet come nearer along the floor it grows with their row.

    Args:
        crowns: (n,) rows of `standing_rows`; NaN where nobody is seen.
        soles: (n,) likewise.
        whole: (n,) True where the silhouette is not cut by the picture's border.
    """
    heights = soles - crowns
    seen = np.isfinite(heights)
    told = seen & (whole if (seen & whole).any() else seen)
    if not told.any():
        return np.full(len(heights), np.nan)
    slope = 0.0
    low, high = np.quantile(soles[told], (0.05, 0.95))
    if high - low > NEARER * np.median(heights[told]):
        from scipy.stats import theilslopes  # takes as long to import as all else does

        some = np.flatnonzero(told)[:: max(1, told.sum() // MOST_SAMPLES)]
        with np.errstate(invalid="ignore"):  # in its error bar, which nobody reads
            slope = float(theilslopes(heights[some], soles[some])[0])
    flat = heights[told] - slope * soles[told]
    level = float(np.quantile(flat, UPRIGHT))
    least = float(np.quantile(heights[told], 0.1))
    found: Vector = np.maximum(level + slope * soles, least)
    return found
