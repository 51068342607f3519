"""The silhouette at a fixed size: cost and angles do not depend on the camera's pixels (T9)."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.body.stick_body import STATURE, X, Y
from common.raster.similarity import Mask

STATURE_PX: Final = 100
"""Stature of the body in the normalised silhouette, pixels."""
NORMAL_SIZE: Final = (128, 160)
"""Width and height of a normalised silhouette, pixels: stretched or raised arms fit in, and a
row is two words."""
INSIDE: Final = 0.5
"""Share of a pixel that the person must cover."""


class Normal(NamedTuple):
    """A silhouette at the fixed size, and its place in the original."""

    mask: Mask
    scale: float
    """Pixels here per pixel of the original."""
    corner: Vector
    """Place in the original of this picture's corner, (2,) px."""

    def inward(self, pose: Vector) -> Vector:
        """A stick pose of the original, in this picture."""
        pose = pose.copy()
        pose[[X, Y]] = (pose[[X, Y]] - self.corner) * self.scale
        pose[STATURE] *= self.scale
        return pose

    def outward(self, pose: Vector) -> Vector:
        """A stick pose of this picture, in the original."""
        pose = pose.copy()
        pose[[X, Y]] = pose[[X, Y]] / self.scale + self.corner
        pose[STATURE] /= self.scale
        return pose


def normalised(mask: Mask, stature_px: float) -> Normal:
    """The silhouette scaled so that a stature is STATURE_PX, the middle of its box in the middle.

    Args:
        mask: (H, W), with a person in it.
        stature_px: Height that the body would have standing upright, in pixels of the mask (T20).
    """
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    scale = STATURE_PX / stature_px
    box = mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    ends = np.array([[columns[0], columns[-1] + 1], [rows[0], rows[-1] + 1]], float)
    corner = ends.mean(axis=1) - np.array(NORMAL_SIZE) / 2 / scale
    across, down = (
        _shares(corner[i] - ends[i, 0], 1.0 / scale, NORMAL_SIZE[i], box.shape[1 - i])
        for i in (0, 1)
    )
    return Normal(down @ box.astype(np.float32) @ across.T > INSIDE, scale, corner)


def _shares(first: float, step: float, cells: int, pixels: int) -> NDArray[np.float32]:
    """Share of each cell of a row that each pixel covers, (cells, pixels).

    Splitting a pixel into several changes nothing, so the same shape in smaller pixels gives the
    same cells.

    Args:
        first: Start of the first cell, from the edge of the first pixel on.
        step: Pixels a cell.
        cells: Number of cells.
        pixels: Number of pixels.
    """
    begin = first + step * np.arange(cells)[:, None]
    pixel = np.arange(pixels)
    shared = np.minimum(begin + step, pixel + 1.0) - np.maximum(begin, pixel)
    return np.asarray(np.maximum(shared, 0.0) / step, np.float32)
