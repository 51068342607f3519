"""Colours of a person's clothes: what tells people apart who were out of sight."""

from typing import Final

import cv2
import numpy as np

from common.body.observation import Observation
from common.raster.silhouette_report import unpack
from common.video.pictures import Image

UPPER: Final = (0.2, 0.5)
"""Shares of a silhouette's height, from above, between which it shows the trunk."""
LOWER: Final = (0.55, 0.9)
"""The same of the legs."""


def clothes_colours(picture: Image, seen: Observation) -> tuple[float, ...]:
    """Mean L*a*b* of the silhouette's upper part, then of its lower part, (6,).

    Args:
        picture: (H, W, 3) uint8, blue, green, red.
        seen: The person in it.
    """
    box, mask = seen.box, unpack(seen)
    high = box.bottom + 1 - box.top
    means: list[float] = []
    for first, last in (UPPER, LOWER):
        rows = slice(box.top + int(first * high), box.top + max(int(last * high), 1))
        part = np.s_[rows, box.left : box.right + 1]
        inside = mask[part].view(np.uint8)
        if not cv2.countNonZero(inside):
            return ()
        mean = np.array(cv2.mean(picture[part], inside)[:3], np.float32).reshape(1, 1, 3) / 255.0
        means += cv2.cvtColor(mean, cv2.COLOR_BGR2LAB).ravel().tolist()
    return tuple(means)
