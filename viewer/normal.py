"""The silhouette at its fixed size: cost and angles do not depend on the camera's pixels (T9)."""

from typing import Final, NamedTuple

import cv2
import numpy as np

from common.body import Vector
from common.similarity import Mask
from common.stickman import STATURE, X, Y

STATURE_PX: Final = 100
"""Stature of the body in the normalised silhouette."""
NORMAL_SIZE: Final = (128, 160)
"""Its width and height: arms stretched out or up fit in, and a row is two words."""
INSIDE: Final = 0.5
"""A pixel belongs to the person of whom it is covered by half."""


class Normal(NamedTuple):
    """A silhouette at its fixed size, and where it lies in the given one."""

    mask: Mask
    scale: float
    """Pixels here for one pixel there."""
    corner: Vector
    """What of the given picture is at the corner of this one, (2,) px."""

    def inward(self, pose: Vector) -> Vector:
        """A stick pose of the given picture, here."""
        pose = pose.copy()
        pose[[X, Y]] = (pose[[X, Y]] - self.corner) * self.scale
        pose[STATURE] *= self.scale
        return pose

    def outward(self, pose: Vector) -> Vector:
        """A stick pose of this picture, in the given one."""
        pose = pose.copy()
        pose[[X, Y]] = pose[[X, Y]] / self.scale + self.corner
        pose[STATURE] /= self.scale
        return pose


def normalised(mask: Mask, stature_px: float) -> Normal:
    """The silhouette scaled so that a stature is STATURE_PX, the middle of its box in the middle.

    Args:
        mask: (H, W), with somebody in it.
        stature_px: Height of the body standing upright, in its pixels (T20).
    """
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    scale = STATURE_PX / stature_px
    middle = np.array([columns[0] + columns[-1] + 1, rows[0] + rows[-1] + 1]) / 2
    corner = middle - np.array(NORMAL_SIZE) / 2 / scale
    first = np.floor(corner).astype(int)
    span = np.ceil(np.array(NORMAL_SIZE) / scale).astype(int) + 2
    piece = _piece(mask, first, span)
    if scale < 1.0:  # the mean of what falls into a pixel, not what is at its centre
        size = [max(1, round(side * scale)) for side in span.tolist()]
        piece = cv2.resize(piece, size, interpolation=cv2.INTER_AREA)
    per = np.array([piece.shape[1], piece.shape[0]]) / span
    shift = (corner - first) * per + 0.5 * per / scale - 0.5
    turn = np.column_stack([np.diag(per / scale), shift])
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    small = cv2.warpAffine(piece, turn, NORMAL_SIZE, flags=flags)
    return Normal(np.asarray(small > INSIDE), scale, corner)


def _piece(mask: Mask, first: Vector, span: Vector) -> cv2.typing.MatLike:
    """A rectangle of the picture, from a pixel on; what lies beyond the picture is empty."""
    last = np.minimum(first + span, [mask.shape[1], mask.shape[0]])
    begin = np.maximum(first, 0)
    piece = np.zeros((int(span[1]), int(span[0])), np.float32)
    (x, y), (ax, ay), (bx, by) = first, begin, last
    if bx > ax and by > ay:
        piece[ay - y : by - y, ax - x : bx - x] = mask[ay:by, ax:bx]
    return piece
