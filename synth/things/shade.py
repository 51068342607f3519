"""Things that are drawn as polygons and lines, of one colour, beside a person in a picture."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector

Floats = NDArray[np.float32]
Shade = NDArray[np.float32]
"""(side_px, side_px) brightness of an opaque thing, 0 where it is not."""
AT: Final = {name: at for at, name in enumerate(JOINT_NAMES)}
FINER_BITS: Final = 3
"""Shapes are drawn to an eighth of a pixel."""


class Place(NamedTuple):
    """Where the person is, in pixels."""

    joints: Floats
    """(15, 2) JOINT_NAMES order."""
    stature: float
    side_px: int
    """Of the picture."""

    def blank(self) -> Shade:
        """No thing yet."""
        return np.zeros((self.side_px, self.side_px), np.float32)

    def middle(self, *names: str) -> Floats:
        """(2,) the mean of some joints."""
        return np.asarray(self.joints[[AT[name] for name in names]].mean(axis=0), np.float32)

    def floor(self) -> float:
        """The row on which the person stands."""
        return float(self.joints[:, 1].max()) + 0.04 * self.stature


def fill(shade: Shade, corners: Floats, value: float) -> None:
    """A polygon of (n, 2) corners, in pixels."""
    fixed = (np.asarray(corners) * (1 << FINER_BITS)).round().astype(np.int32)
    cv2.fillPoly(shade, [fixed], value, shift=FINER_BITS)


def block(shade: Shade, low: tuple[float, float], high: tuple[float, float], value: float) -> None:
    """A rectangle between two corners."""
    (left, top), (right, bottom) = low, high
    fill(shade, np.array([[left, top], [right, top], [right, bottom], [left, bottom]]), value)


def line(shade: Shade, ends: Sequence[Vector | Floats], wide: float, value: float) -> None:
    """A line from end to end, so many pixels wide, one at least."""
    fixed = (np.array(ends) * (1 << FINER_BITS)).round().astype(np.int32)
    cv2.polylines(shade, [fixed], False, value, max(1, round(wide)), shift=FINER_BITS)


def disc(shade: Shade, middle: Floats, radii: tuple[float, float], wide: float = -1.0) -> None:
    """An ellipse, filled or a ring."""
    x, y = (round(float(value)) for value in middle)
    axes = (max(1, round(radii[0])), max(1, round(radii[1])))
    cv2.ellipse(shade, (x, y), axes, 0, 0, 360, 0.7, -1 if wide < 0 else max(1, round(wide)))
