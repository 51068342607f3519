"""The part of each picture in which the board was seen: as a share, and drawn."""

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

CELLS: Final = 48
"""Number of cells across a picture."""
WIDE_PX: Final = 480
"""Width of each drawn picture, pixels."""
TINT: Final = (80, 200, 60)
"""Tint of covered cells: blue, green, red."""
OFTEN: Final = 4
"""Number of rests that give the full tint."""


def covered(px: Vector, size_px: tuple[int, int]) -> NDArray[np.int64]:
    """How often each cell of a camera's picture lay inside the board's corners.

    Args:
        px: (m, n, 2) the corners at each rest, NaN where hidden.
        size_px: Width and height of the picture.

    Returns:
        (rows, CELLS)
    """
    scale = CELLS / size_px[0]
    cells = np.zeros((round(size_px[1] * scale), CELLS), np.int64)
    for places in px:
        seen = places[np.isfinite(places[:, 0])]
        if len(seen):
            hull = cv2.convexHull(np.round(seen * scale).astype(np.int32))
            cells += cv2.fillConvexPoly(np.zeros(cells.shape, np.uint8), hull, 1)
    return cells


def coverage_picture(
    pictures: Sequence[NDArray[np.uint8]], cells: Sequence[NDArray[np.int64]]
) -> NDArray[np.uint8]:
    """The cameras' pictures side by side, darkened, with the covered cells in green."""
    return np.concatenate(
        [tinted(picture, some) for picture, some in zip(pictures, cells, strict=True)], axis=1
    )


def tinted(picture: NDArray[np.uint8], cells: NDArray[np.int64]) -> NDArray[np.uint8]:
    """A picture, WIDE_PX wide and darkened, with the covered cells in green."""
    size = (WIDE_PX, round(WIDE_PX * picture.shape[0] / picture.shape[1]))
    ground = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(float) / 2
    share = np.minimum(cells, OFTEN).astype(np.float32) / OFTEN * 0.6
    weight = cv2.resize(share, size, interpolation=cv2.INTER_NEAREST)[..., None]
    drawn: NDArray[np.uint8] = (ground * (1 - weight) + np.array(TINT) * weight).astype(np.uint8)
    cv2.rectangle(drawn, (0, 0), (size[0] - 1, size[1] - 1), (255, 255, 255), 1)
    return drawn
