"""Where a person may stand in the median picture of a busy clip (3.1.2)."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.raster.similarity import Mask
from viewer.background.background import large_regions, slopes
from viewer.background.empty_opening import EDGE_SHARE
from viewer.background.image_stack import CHANGES, LUMA, Floats

NOISES: Final = 4.0
"""Spreads of a pixel's own flicker that a change must exceed in addition to CHANGES."""
MOST_FLICKER: Final = 2 * CHANGES
QUIET: Final = 0.25
"""Share of the frames in which a pixel's deviation defines its flicker."""
ROAMS: Final = 0.55
"""Sideways motion of a region's middle, over its height, above which a person uncovers every
pixel for most of the clip. It is 0.5 to 2.0 for a person who crosses a picture, up to 0.5 on the
spot."""
RARELY: Final = 0.1
"""Share of the frames that must differ at a place where a roaming person stands in the median
picture. A smaller share means background in front of which arms pass; its own edges look like
contours."""
LEAST_BLOB: Final = 0.2
"""Share of the largest change at a place below which a frame does not show where the middle is."""
AROUND: Final = 0.25
"""Window in which contours are pooled, heights of the picture: half a person."""


def occupied(even: Floats, centre: Floats, away: Floats, stays: bool) -> Mask:
    """(H, W) True in the hulls of the places where a person may stand in the median picture.

    Args:
        even: (n, H, W, 3) frames under one light.
        centre: (H, W, 3), their median.
        away: (n, H, W), their distance from it.
        stays: Whether changes that stay in place count; otherwise only what their contours show.
    """
    flicker = np.minimum(NOISES * np.quantile(away, QUIET, axis=0), MOST_FLICKER)
    changed = np.stack([large_regions(off > CHANGES + flicker) for off in away])
    hidden, often = _in_median(even, centre, changed), changed.mean(axis=0) > RARELY
    gap = 2 * (centre.shape[0] // 60) + 1
    joined = cv2.dilate(changed.max(axis=0), np.ones((gap, gap), np.uint8))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(joined)
    places = np.zeros(labels.shape, np.uint8)
    for number in range(1, count):
        own = labels == number
        roams = _travelled(changed, own) > ROAMS * stats[number, cv2.CC_STAT_HEIGHT]
        there = hidden & often if roams else hidden | stays
        places |= own & there
    return _hulls(places)


def _in_median(even: Floats, centre: Floats, changed: NDArray[np.uint8]) -> Mask:
    """(H, W) True where contours of changes are in the median picture, not in the frames."""
    slope = slopes(np.asarray(centre @ LUMA, np.float32))
    in_median, in_frames = np.zeros_like(slope), np.zeros_like(slope)
    for frame, own in zip(even, changed, strict=True):
        contour = cv2.morphologyEx(own, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 0
        steeper = np.where(contour, slopes(np.asarray(frame @ LUMA, np.float32)) - slope, 0)
        in_frames += steeper.clip(min=0)
        in_median -= steeper.clip(max=0)
    reach = 2 * round(AROUND * len(slope) / 2) + 1
    held, due = (cv2.blur(sums, (reach, reach)) for sums in (in_median, in_frames))
    return np.asarray(held > EDGE_SHARE * due)


def _travelled(changed: NDArray[np.uint8], own: Mask) -> float:
    """Sideways motion of the middle of the changes in a place, pixels."""
    columns = (changed * own).sum(axis=1)
    areas = columns.sum(axis=1)
    seen = areas > LEAST_BLOB * areas.max()
    middles = columns[seen] @ np.arange(own.shape[1]) / areas[seen]
    low, high = np.quantile(middles, (0.05, 0.95))
    return float(high - low)


def _hulls(regions: NDArray[np.uint8]) -> Mask:
    """The convex hull of every region."""
    reach = max(1, regions.shape[0] // 60)
    joined = cv2.dilate(regions, np.ones((2 * reach + 1, 2 * reach + 1), np.uint8))
    contours, _ = cv2.findContours(joined, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    out = np.zeros(regions.shape, np.uint8)
    for contour in contours:
        cv2.fillConvexPoly(out, cv2.convexHull(contour), 1)
    return out > 0
