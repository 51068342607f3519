"""Rotations between directions, many at a time: functions that scipy's Rotation lacks."""

from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from common.body.body import Vector
from common.body.extremities import cross

OPPOSITE: Final = 1e-12
"""Distance from opposite within which two directions count as such: any turn of 180 degrees maps
one to the other."""


def arc(start: Vector, ends: NDArray[np.float64]) -> Rotation:
    """The shortest turns from a direction (3,) to directions (n, 3): they have no twist."""
    return Rotation.from_quat(_half(start, ends), scalar_first=True)


def arc_axes(starts: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same as matrices (..., 3, 3), for directions (..., 3): faster where there are few."""
    quaternions = _half(starts, ends)
    quaternions /= np.sqrt((quaternions**2).sum(axis=-1, keepdims=True))
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    across = np.zeros((*w.shape, 3, 3))
    across[..., 2, 1], across[..., 0, 2], across[..., 1, 0] = x, y, z
    across -= across.swapaxes(-1, -2)
    found: NDArray[np.float64] = across @ across
    found += w[..., None, None] * across
    found *= 2.0
    found[..., (0, 1, 2), (0, 1, 2)] += 1.0
    return found


def _half(starts: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (..., 4) of the shortest turns, w first, of any length."""
    a = starts / np.linalg.norm(starts, axis=-1, keepdims=True)
    b = ends / np.maximum(np.linalg.norm(ends, axis=-1, keepdims=True), OPPOSITE)
    wxyz = np.empty((*b.shape[:-1], 4))
    wxyz[..., 0] = 1.0 + (a * b).sum(axis=-1)
    wxyz[..., 1:] = cross(a, b)
    opposite = wxyz[..., 0] < OPPOSITE
    if opposite.any():
        a = np.broadcast_to(a, b.shape)[opposite]
        wxyz[opposite, 0] = 0.0
        wxyz[opposite, 1:] = np.cross(a, np.eye(3)[np.abs(a).argmin(axis=-1)])
    return wxyz


def axes_of(
    up: NDArray[np.float64], across: NDArray[np.float64], keep: Literal["up", "across"] = "up"
) -> NDArray[np.float64]:
    """The turns that map +y to `up` and +x to `across`, (n, 3) each, as matrices (n, 3, 3).

    Args:
        up: (n, 3).
        across: (n, 3), not parallel to it.
        keep: Which of the two is met exactly; the other is made perpendicular to it.
    """
    out = cross(across, up)
    x, y = (cross(up, out), up) if keep == "up" else (across, cross(out, across))
    axes = np.stack([x, y, out], axis=-1)
    unit: NDArray[np.float64] = axes / np.linalg.norm(axes, axis=-2, keepdims=True)
    return unit


def unbroken(xyzw: Vector) -> Vector:
    """Of q and -q, which are one turn, the one nearer to the frame before: players interpolate."""
    turned = (xyzw[1:] * xyzw[:-1]).sum(axis=1) < 0
    signs = np.where(np.logical_xor.accumulate(np.concatenate([[False], turned])), -1.0, 1.0)
    followed: Vector = xyzw * signs[:, None]
    return followed
