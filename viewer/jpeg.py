"""Small pictures for the page, published only where the settings allow it."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

QUALITY: Final = 70


def jpeg_of(picture: NDArray[np.uint8]) -> bytes:
    """A picture (H, W, 3), BGR, as JPEG."""
    _, encoded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return bytes(encoded.tobytes())
