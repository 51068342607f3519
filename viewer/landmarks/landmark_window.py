"""The part of a picture that the network of landmarks looks at."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.bus.messages import Box
from common.raster.similarity import Mask
from common.video.decoding import Image

SIDE: Final = 192
"""Pixels across what the network sees."""
FRAMED: Final = 1.25
"""Side of the window over the longer side of what it is to hold."""
PLANES: Final = 4
"""Blue, green, red, outline."""
GREY: Final = 128
"""Of an outline that is not known: what the network takes for 0."""

Planes = NDArray[np.uint8]


class Window(NamedTuple):
    """A square, whole pixels of the picture; it may reach beyond it."""

    left: int
    top: int
    side: int


def window_about(left: float, right: float, top: float, bottom: float) -> Window:
    """The window of what reaches from one pixel to another."""
    side = max(8, round(FRAMED * max(right - left, bottom - top)))
    return Window(round((left + right - side) / 2), round((top + bottom - side) / 2), side)


def window_of(box: Box) -> Window:
    """The window of an outline."""
    return window_about(box.left, box.right + 1, box.top, box.bottom + 1)


def whole(shape: tuple[int, ...]) -> Window:
    """The window that holds all of a picture (H, W, ...)."""
    side = max(shape[:2])
    return Window((shape[1] - side) // 2, (shape[0] - side) // 2, side)


def planes_of(picture: Image, mask: Mask | None, window: Window, side: int = SIDE) -> Planes:
    """What the network sees, (1, PLANES, side, side); black beyond the picture.

    Args:
        picture: (H, W, 3)
        mask: (H, W) the outline; None: not known.
        window: Of the picture.
        side: Pixels across.
    """
    planes = np.full((1, PLANES, side, side), GREY, np.uint8)
    for plane, colour in zip(planes[0], cv2.split(_cut(picture, window, side)), strict=False):
        plane[:] = colour
    if mask is not None:
        outline = _cut(mask.view(np.uint8) * np.uint8(255), window, side)
        cv2.threshold(outline, 127, 255, cv2.THRESH_BINARY, planes[0, 3])
    return planes


def _cut(picture: NDArray[np.uint8], window: Window, across: int) -> NDArray[np.uint8]:
    """(across, across, ...) of the picture.

    Means of whole pixels first, then what lies between them: means over any part of pixels would
    take five times as long.
    """
    left, top, side = window
    times = max(1, round(side / across))
    few = -(-side // times)
    held = _held(picture, left, top, few * times)
    if times > 1:
        held = np.asarray(cv2.resize(held, (few, few), interpolation=cv2.INTER_AREA), np.uint8)
    scale = across * times / side
    return np.asarray(cv2.resize(held, None, fx=scale, fy=scale)[:across, :across], np.uint8)


def _held(picture: NDArray[np.uint8], left: int, top: int, side: int) -> NDArray[np.uint8]:
    """(side, side, ...) of the picture; black beyond it."""
    high, wide = picture.shape[:2]
    rows, columns = _within(top, side, high), _within(left, side, wide)
    inside = picture[slice(*rows), slice(*columns)]
    if inside.shape[:2] == (side, side):
        return inside
    held = np.zeros((side, side, *picture.shape[2:]), np.uint8)
    if rows[0] < rows[1] and columns[0] < columns[1]:
        held[slice(*np.subtract(rows, top)), slice(*np.subtract(columns, left))] = inside
    return held


def _within(start: int, count: int, size: int) -> tuple[int, int]:
    """First and last of so many that are from 0 to size; none below 0, which would count back."""
    return max(start, 0), min(max(start + count, 0), size)
