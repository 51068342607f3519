"""How tall a person would stand at every place of a video: the scale of a single view (T20)."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from common.body.body import Vector
from common.raster.similarity import Mask

MIDDLE_SHARE: Final = 0.05
"""Half the width, in heights, of the column in which the head is looked for: raised arms pass."""
UPRIGHT: Final = 0.75
"""Of the heights of a clip, the one that so many stay below: most of them stand, few jump."""
NEARER: Final = 0.15
"""Feet that move by this share of the height show that the person comes nearer."""
MOST_SAMPLES: Final = 300
"""Most heights that the slope is fitted to."""


class Standing(NamedTuple):
    """The height of a person upright, by the row on which they stand."""

    sole_row: float
    """Row below the feet, in most frames."""
    tall_px: float
    """Height there."""
    level_px: float
    """Height where the row is 0; what a row more adds is `slope`."""
    slope: float
    least_px: float
    """No frame is lower: what squats is no measure."""

    def at(self, sole_row: float) -> float:
        """Height in pixels of a person whose feet are on a row."""
        return max(self.level_px + self.slope * sole_row, self.least_px)


def standing_rows(mask: Mask) -> tuple[float, float]:
    """Row of the crown over the middle of a silhouette, and row below its feet, pixels."""
    rows, columns = np.nonzero(mask)
    bottom = int(rows.max()) + 1
    half = max(1.0, MIDDLE_SHARE * (bottom - int(rows.min())))
    beside = np.abs(columns - np.median(columns))
    middle = beside <= max(half, beside.min())  # the middle of two parts may lie between them
    return float(rows[middle].min()), float(bottom)


def standing_of(rows: Sequence[tuple[float, float]], whole: Sequence[bool]) -> Standing | None:
    """Height of the person standing upright, by all silhouettes of a video; None without any.

    One height of the video holds for all frames, not each frame's own: a squat would shrink it.
    Where the feet come nearer along the floor it grows with their row.

    Args:
        rows: (n,) `standing_rows` of each silhouette.
        whole: (n,) True where it is not cut by the picture's border.
    """
    if not rows:
        return None
    both, uncut = np.array(rows, np.float64), np.array(whole, np.bool_)
    samples = both[uncut] if uncut.any() else both
    soles, heights = samples[:, 1], samples[:, 1] - samples[:, 0]
    slope = 0.0
    low, high = np.quantile(soles, (0.05, 0.95))
    if high - low > NEARER * np.median(heights):
        slope = _slope(soles, heights)
    level = float(np.quantile(heights - slope * soles, UPRIGHT))
    sole = float(np.median(both[:, 1]))
    least = float(np.quantile(heights, 0.1))
    return Standing(sole, max(level + slope * sole, least), level, slope, least)


def _slope(soles: Vector, heights: Vector) -> float:
    """How much taller a row nearer makes who stands (Theil and Sen: a median of slopes)."""
    from scipy.stats import theilslopes

    some = slice(None, None, max(1, len(soles) // MOST_SAMPLES))
    with np.errstate(invalid="ignore"):  # in its error bar, which nobody reads
        return float(theilslopes(heights[some], soles[some])[0])
