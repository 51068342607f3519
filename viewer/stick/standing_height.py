"""The height of a standing person at every place of a video: the scale of a single view (T20)."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from common.body.body import Vector
from common.raster.similarity import Mask

MIDDLE_SHARE: Final = 0.05
"""Half width, in heights, of the column in which the head is searched: raised arms are outside."""
UPRIGHT: Final = 0.75
"""Quantile of a clip's heights: most of them stand, few jump."""
NEARER: Final = 0.15
"""Motion of the feet, as a share of the height, that shows a change of distance."""
MOST_SAMPLES: Final = 300
"""Largest number of heights that the slope is fitted to."""


class Standing(NamedTuple):
    """Height of an upright person, by the row on which they stand."""

    sole_row: float
    """Median row below the feet."""
    tall_px: float
    """Height there."""
    level_px: float
    """Height at row 0; `slope` is the gain per row."""
    slope: float
    least_px: float
    """Smallest height that counts: a squat is no measure."""

    def at(self, sole_row: float) -> float:
        """Height in pixels of a person with the feet on a row."""
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
    """Height of the standing person, from all silhouettes of a video; None without any.

    One height holds for all frames of the video, not each frame's own: a squat would shrink it.
    Where the feet approach along the floor it grows with their row.

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
    """Gain of a standing person's height per row (Theil and Sen: a median of slopes)."""
    from scipy.stats import theilslopes

    some = slice(None, None, max(1, len(soles) // MOST_SAMPLES))
    with np.errstate(invalid="ignore"):  # in its confidence interval, which is not used
        return float(theilslopes(heights[some], soles[some])[0])
