"""The part of a picture that the network of landmarks looks at."""

import math
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.observation import Box
from common.raster.similarity import Mask
from common.video.pictures import Image

SIDE: Final = 192
"""Pixels across what the network sees."""
FRAMED: Final = 1.25
"""Side of the window over the longer side of what it is to hold."""
PLANES: Final = 4
"""Blue, green, red, silhouette."""
CORNERS: Final = (math.sqrt(2.0) - 1.0) / 2.0
"""How far the corners of a turned square reach beyond it, in sides."""
SHARED: Final = 0.7
"""Intersection over union from which windows are of one person."""
GREY: Final = 128
"""Of a silhouette that is not known: what the network takes for 0."""

Planes = NDArray[np.uint8]
Places = NDArray[np.float64]


class Window(NamedTuple):
    """A square, whole pixels of the picture, turned about its middle; it may reach beyond it."""

    left: int
    top: int
    side: int
    turn_deg: float = 0.0
    """From the picture's upward direction to the window's, clockwise."""

    def in_picture(self, places: Places) -> Places:
        """Where places in the planes, (n, 2), are in the picture."""
        middle = np.array([self.left, self.top]) + self.side / 2
        return (places * (self.side / SIDE) - self.side / 2) @ _turn(self.turn_deg) + middle


def window_about(places: Places, turn_deg: float = 0.0, margin: float = 0.0) -> Window:
    """The window of what reaches as far as places, (n, 2), and beyond.

    Args:
        places: Of the picture, at least one.
        turn_deg: Of the window.
        margin: How far it reaches beyond them, in the longer side of what holds them.
    """
    turn = _turn(turn_deg)
    turned = places @ turn.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    side = max(8, round(FRAMED * (1.0 + 2.0 * margin) * float((high - low).max())))
    left, top = ((low + high) / 2 @ turn - side / 2).tolist()
    return Window(round(left), round(top), side, turn_deg)


def window_of(box: Box) -> Window:
    """The window of a silhouette, as the picture stands."""
    return window_about(np.array([(box.left, box.top), (box.right + 1.0, box.bottom + 1.0)]))


def turned_window_of(mask: Mask, turn_deg: float) -> Window:
    """The window of a silhouette (H, W) that is not empty."""
    pixels = np.asarray(cv2.findNonZero(mask.view(np.uint8)), np.float64).reshape(-1, 2)
    return window_about(pixels + 0.5, turn_deg)


def whole(shape: tuple[int, ...]) -> Window:
    """The window that holds all of a picture (H, W, ...)."""
    side = max(shape[:2])
    return Window((shape[1] - side) // 2, (shape[0] - side) // 2, side)


def same_place(first: Window, second: Window) -> bool:
    """Whether two windows are of one person: the common part is at least SHARED of their union."""
    starts = ((first.left, second.left), (first.top, second.top))
    shared = [max(0, min(a + first.side, b + second.side) - max(a, b)) for a, b in starts]
    common = shared[0] * shared[1]
    return common >= SHARED * (first.side**2 + second.side**2 - common)


def planes_of(picture: Image, mask: Mask | None, window: Window, side: int = SIDE) -> Planes:
    """What the network sees, (1, PLANES, side, side); black beyond the picture.

    Args:
        picture: (H, W, 3)
        mask: (H, W) the silhouette; None: not known.
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
    """(across, across, ...) of the picture."""
    if not window.turn_deg:
        return _upright(picture, window, across)
    side, beyond = window.side, round(CORNERS * window.side)
    around = Window(window.left - beyond, window.top - beyond, side + 2 * beyond)
    wide = round(across * around.side / side)
    middle = (wide - 1) / 2
    onto = cv2.getRotationMatrix2D((middle, middle), window.turn_deg, 1.0)
    onto[:, 2] -= (wide - across) / 2
    return np.asarray(cv2.warpAffine(_upright(picture, around, wide), onto, (across, across)))


def _upright(picture: NDArray[np.uint8], window: Window, across: int) -> NDArray[np.uint8]:
    """The same of what lies about the window's middle and is not turned.

    Means of whole pixels first, then what lies between them: means over any part of pixels would
    take five times as long.
    """
    left, top, side, _ = window
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


def _turn(turn_deg: float) -> Places:
    """(2, 2) what turns places of the picture (columns) to those of a turned window."""
    turn = math.radians(turn_deg)
    return np.array([(math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))])


def _within(start: int, count: int, size: int) -> tuple[int, int]:
    """First and last of so many that are from 0 to size; none below 0, which would count back."""
    return max(start, 0), min(max(start + count, 0), size)
