"""The silhouette as the paper prints it: subtraction, threshold, morphology (section 1; P3, P4)."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.video.pictures import Image
from viewer.background.background import Background
from viewer.background.image_stack import Floats

TIMES: Final = 2.0
"""How many times the flicker a pixel must leave its range by; W4's own."""
LEAST: Final = 20.0
"""Least difference from the background, grey levels: chosen among 4 to 20 on two performers
(docs/measurements.md)."""
SQUARE: Final = np.ones((3, 3), np.uint8)
"""Structuring element of the closing, pixels. An opening by it as well would erode the limbs at
160x120: IoU 0.58 and 0.64 of views 1 and 2 instead of 0.74 and 0.68 (docs/measurements.md)."""
HOLE_SHARE: Final = 0.001
"""Holes up to this share of the picture are filled; between arm and trunk there are larger."""


class Printed(NamedTuple):
    """What a frame shows beside the background."""

    mask: NDArray[np.uint8]
    """(H, W) 1 in the region that is taken for the person."""
    blobs: int
    """How many regions were high enough to be one (P4)."""


def printed(
    background: Background,
    frame: Image,
    gain: Floats,
    least_rows: float,
    near_px: tuple[float, float] | None,
) -> Printed:
    """The one person in a frame, by W4's background model.

    The papers that section 1 cites keep, of every pixel, the smallest and the largest grey levels
    that it had while the scene was empty, and the largest step between two frames; what leaves
    that range by more than the median of those steps times a factor is foreground. It is closed,
    and of its regions the largest is kept, or the nearest to where the body is expected, its
    holes filled. Shadows and changes of the light are foreground as well.

    Args:
        background: With its range.
        frame: (H, W, 3).
        gain: (3,) how much brighter than the background it is taken to be.
        least_rows: A lower region is no person.
        near_px: Where the centre of the body is expected; None: the largest region is taken.
    """
    level = frame / gain
    beyond = np.maximum(background.low - level, level - background.high).max(axis=2)
    limit = max(LEAST, TIMES * float(np.median(background.step)))
    mask = cv2.morphologyEx((beyond > limit).astype(np.uint8), cv2.MORPH_CLOSE, SQUARE)
    contours, tree = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    outer = [n for n, contour in enumerate(contours) if tree[0, n, 3] < 0]
    high = [n for n in outer if cv2.boundingRect(contours[n])[3] >= least_rows]
    person = np.zeros_like(mask)
    if high:
        best = max(high, key=lambda n: _near(contours[n], near_px))
        cv2.drawContours(person, contours, best, 1, cv2.FILLED)
        for n, contour in enumerate(contours):
            if tree[0, n, 3] == best and cv2.contourArea(contour) >= HOLE_SHARE * mask.size:
                cv2.drawContours(person, contours, n, 0, cv2.FILLED)
                cv2.drawContours(person, contours, n, 1)
    return Printed(np.asarray(person, np.uint8), len(high))


def _near(contour: NDArray[np.int32], place_px: tuple[float, float] | None) -> float:
    """How much a region is the one that is meant: how near to a place, or how large."""
    if place_px is None:
        return float(cv2.contourArea(contour))
    return float(cv2.pointPolygonTest(contour, place_px, True))
