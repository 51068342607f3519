"""Where a silhouette stands in its picture."""

import cv2
import numpy as np
from numpy.typing import NDArray

from common.bus.messages import Box
from common.raster.similarity import Mask


def box_of(mask: Mask | NDArray[np.uint8]) -> Box | None:
    """The boundary of a silhouette (H, W); None where it is empty (P11)."""
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    if width == 0:
        return None
    return Box(left=left, right=left + width - 1, top=top, bottom=top + height - 1)


def is_cut(box: Box | None, shape: tuple[int, ...]) -> bool:
    """Whether what has such a boundary in a picture of (H, W) may go on beyond it; nothing may."""
    if box is None:
        return False
    height, width = shape[:2]
    inside = box.left > 0 and box.top > 0 and box.right < width - 1 and box.bottom < height - 1
    return not inside
