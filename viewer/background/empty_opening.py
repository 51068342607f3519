"""Whether the opening frames of a clip show the background without a person."""

from collections.abc import Iterable
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import INLINE, KERNEL
from common.video.pictures import Image
from viewer.background.background import large_regions, light_gain
from viewer.background.image_stack import CHANGES, LUMA, Bytes, Floats, Overlaid

EDGE_SHARE: Final = 0.45
"""Share of their gradient that contours of later changes keep in the opening: less where it is
empty, more otherwise. 0.05-0.41 and 0.49-2.5 on every third development clip."""


def is_still(opening: Overlaid) -> bool:
    """Whether no person moves in the opening frames: a person who runs through them leaves no
    contour."""
    return not any(large_regions(off).any() for off in opening.moving if off.any())


def is_empty_opening(opening: Overlaid, sample: Iterable[Image]) -> bool:
    """Whether the opening frames show the background without a person.

    A difference between the opening and a later frame has its contour in every picture that holds
    the person. If the opening is empty that is the later one alone; if a person stood there it is
    both.

    Args:
        opening: The first frames of a clip.
        sample: Frames from the whole clip, of the same size.
    """
    background = np.asarray(opening.median @ LUMA, np.float32)
    in_background, in_frames = 0.0, 0.0
    for frame in sample:
        light = light_gain(frame, opening.median)
        luma, differs = _brightness(frame, LUMA / light, background)
        steeper, flatter = _steeper(*_contour(large_regions(differs)), luma, background)
        in_frames += steeper
        in_background += flatter
    return in_background <= EDGE_SHARE * in_frames


@KERNEL
def _brightness(
    frame: Image, shares: Floats, background: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """The brightness of a frame, (H, W), and the mask of differences from the background."""
    luma, differs = np.empty_like(background), np.empty(background.shape, np.bool_)
    blue, green, red = shares[0], shares[1], shares[2]
    for y in range(len(background)):
        given, own = frame[y], luma[y]
        for x in range(background.shape[1]):
            b, g, r = np.float32(given[x, 0]), np.float32(given[x, 1]), np.float32(given[x, 2])
            own[x] = blue * b + green * g + red * r
            differs[y, x] = abs(own[x] - background[y, x]) > CHANGES
    return luma, differs


def _contour(regions: Bytes) -> tuple[Bytes, int, int]:
    """The contour of all regions in a common window, and the window's first row and column."""
    left, top, width, height = cv2.boundingRect(regions)
    left, top = max(left - 1, 0), max(top - 1, 0)
    window = regions[top : top + height + 2, left : left + width + 2]
    contour = cv2.morphologyEx(window, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    return np.asarray(contour, np.uint8), top, left


@KERNEL
def _steeper(
    contour: Bytes, top: int, left: int, luma: Floats, background: Floats
) -> tuple[float, float]:
    """Sum over a contour of the gradient's increase, and of its decrease, relative to the
    background."""
    steeper, flatter = 0.0, 0.0
    for i in range(len(contour)):
        for j in range(contour.shape[1]):
            if contour[i, j]:
                more = _slope(luma, top + i, left + j) - _slope(background, top + i, left + j)
                steeper += float(max(more, np.float32(0)))
                flatter -= float(min(more, np.float32(0)))
    return steeper, flatter


@INLINE
def _slope(luma: Floats, y: int, x: int) -> np.float32:
    """Gradient of the brightness at a pixel, by Sobel's operator; mirrored at the border."""
    up, down = abs(y - 1), len(luma) - 1 - abs(len(luma) - 2 - y)
    left, right = abs(x - 1), luma.shape[1] - 1 - abs(luma.shape[1] - 2 - x)
    two = np.float32(2)
    across = luma[up, right] - luma[up, left] + luma[down, right] - luma[down, left]
    across += two * (luma[y, right] - luma[y, left])
    along = luma[down, left] - luma[up, left] + luma[down, right] - luma[up, right]
    along += two * (luma[down, x] - luma[up, x])
    return np.sqrt(across * across + along * along)
