"""Regions of a coarse picture in which a person may be, and those that are one person's."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import compiled
from viewer.background.image_stack import Bytes

APART_SHARE: Final = 0.2
"""Regions this share of the picture's height apart can still be one body."""
LEFT, TOP, RIGHT, BOTTOM = range(4)
"""Of a region's box, the last ones excluded."""
AROUND: Final = np.ones((3, 3), np.uint8)
"""A cell and those that touch it."""


def chosen(
    found: Bytes, least_share: float, near: tuple[float, float] | None = None
) -> tuple[Bytes, int]:
    """The cells around the person's region, and how many regions could be a person.

    Args:
        found: (rows, columns) 1 where something is.
        least_share: Of the picture's height, as tall as a person is at least.
        near: Column and row where the middle of the person is expected; None: the largest region
            is taken.
    """
    joined = np.asarray(cv2.dilate(found, AROUND), np.uint8)
    count, labels, stats, middles = cv2.connectedComponentsWithStatsWithAlgorithm(
        joined, 8, cv2.CV_16U, cv2.CCL_GRANA
    )
    # joining made every region two cells taller
    large = stats[:, cv2.CC_STAT_HEIGHT] - 2 >= least_share * len(found)
    large[0] = False  # what no region covers
    if count <= 2 or not large.any():
        return joined, int(large.any())
    worth = stats[:, cv2.CC_STAT_AREA].astype(np.float64)
    if near is not None:
        worth = -np.hypot(*(middles + 0.5 - near).T)
    best = int(np.argmax(np.where(large, worth, -np.inf)))
    own = same_body(boxes_of(stats), best, len(found))
    own[0] = False
    return own.view(np.uint8)[labels], 1 + int(np.count_nonzero(large & ~own))


def boxes_of(stats: NDArray[np.int32]) -> NDArray[np.int32]:
    """(n, 4), LEFT to BOTTOM of what OpenCV counts of each region."""
    boxes = stats[:, :4].copy()
    boxes[:, RIGHT:] += boxes[:, :RIGHT]
    return boxes


@compiled
def same_body(regions: NDArray[np.int32], best: int, rows: int) -> NDArray[np.bool_]:
    """Which regions stand over or under the best one, or all but touch it.

    Clothes of the wall's colour part a body across; people who stand side by side do not overlap.

    Args:
        regions: (n, 4), LEFT to BOTTOM of each.
        best: Which of them is a person's.
        rows: Of the picture.
    """
    own = np.zeros(len(regions), np.bool_)
    one = regions[best]
    for n in range(len(regions)):
        other = regions[n]
        overlap = min(other[RIGHT], one[RIGHT]) - max(other[LEFT], one[LEFT])
        gap = max(other[TOP], one[TOP]) - min(other[BOTTOM], one[BOTTOM])
        wide = overlap > 0.5 * (other[RIGHT] - other[LEFT])
        own[n] = n == best or (wide and gap < APART_SHARE * rows)
    return own
