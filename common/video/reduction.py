"""Reduced pictures: at the working size, and as JPEG."""

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np

from common.video.pictures import Image

JPEG_QUALITY: Final = 70
"""JPEG quality, of 100, as OpenCV counts it: a page shows several pictures a second."""


def reduced(picture: Image, size: Sequence[int], quarters: int) -> Image:
    """A picture turned clockwise by quarter turns and resized to (width, height).

    Each pixel is the mean of the area that it covers (P1).
    """
    width, height = size
    lying = (height, width) if quarters % 2 else (width, height)
    if (picture.shape[1], picture.shape[0]) != lying:
        picture = cv2.resize(picture, lying, interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(np.rot90(picture, -quarters)) if quarters else picture


def jpeg_of(picture: Image) -> bytes:
    """A picture as JPEG, for the page and for reports."""
    _, encoded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return bytes(encoded.tobytes())
