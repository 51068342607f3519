"""Turns that lead directions to directions, many at a time: what scipy's Rotation leaves out."""

from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from common.body.body import Vector

OPPOSITE: Final = 1e-12
"""Two directions that are opposite but for rounding: any turn of 180 degrees leads one to the
other."""


def arc(start: Vector, ends: NDArray[np.float64]) -> Rotation:
    """The shortest turns that lead a direction (3,) to directions (n, 3): they twist nothing."""
    a = start / np.linalg.norm(start)
    b = ends / np.maximum(np.linalg.norm(ends, axis=-1, keepdims=True), OPPOSITE)
    w = 1.0 + b @ a
    opposite = w < OPPOSITE
    aside = np.cross(a, np.eye(3)[np.abs(a).argmin()])
    axis = np.where(opposite[:, None], aside, np.cross(a, b))
    w = np.where(opposite, 0.0, w)
    return Rotation.from_quat(np.column_stack([w, axis]), scalar_first=True)


def frame_of(
    up: NDArray[np.float64], across: NDArray[np.float64], keep: Literal["up", "across"] = "up"
) -> Rotation:
    """The turns that lead +y to `up` and +x to `across`, (n, 3) each.

    Args:
        up: (n, 3).
        across: (n, 3), not parallel to it.
        keep: Which of the two is met exactly; the other is made square to it.
    """
    out = np.cross(across, up)
    x, y = (np.cross(up, out), up) if keep == "up" else (across, np.cross(out, across))
    axes = np.stack([x, y, out], axis=-1)
    unit = axes / np.linalg.norm(axes, axis=-2, keepdims=True)
    return Rotation.from_matrix(unit, assume_valid=True)
