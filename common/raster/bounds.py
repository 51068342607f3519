"""Where a silhouette stands in its picture."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from common.bus.messages import Box
from common.compiled import compiled
from common.raster.similarity import Mask


def box_of(mask: Mask | NDArray[np.uint8]) -> Box | None:
    """The boundary of a silhouette (H, W); None where it is empty (P11)."""
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    if width == 0:
        return None
    return Box(left=left, right=left + width - 1, top=top, bottom=top + height - 1)


@compiled
def centroid_px(mask: Any) -> tuple[float, float]:
    """Mean column and row of what is in a mask (H, W), which is not empty.

    Compiled: 3 us at 320x240, where cv2.moments takes 185.
    """
    area = along = down = 0
    for y in range(mask.shape[0]):
        here = 0
        for x in range(mask.shape[1]):
            here += mask[y, x]
            along += x * mask[y, x]
        area += here
        down += y * here
    return along / area + 0.5, down / area + 0.5


def is_cut(box: Box | None, shape: tuple[int, ...]) -> bool:
    """Whether what has such a boundary in a picture of (H, W) may go on beyond it; nothing may."""
    if box is None:
        return False
    height, width = shape[:2]
    inside = box.left > 0 and box.top > 0 and box.right < width - 1 and box.bottom < height - 1
    return not inside
