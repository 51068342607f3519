"""Turns in space as unit quaternions (w, x, y, z): joined, applied, written as Euler angles."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

Turns = NDArray[np.float64]
"""(..., 4), unit length; q and -q are one turn."""

OPPOSITE = 1e-12
"""Two directions that are opposite but for rounding: any turn of 180 degrees leads one to the
other."""


def times(first: Turns, second: Turns) -> Turns:
    """`second`, then `first`: the product of their matrices."""
    a, u = first[..., :1], first[..., 1:]
    b, v = second[..., :1], second[..., 1:]
    w = a * b - (u * v).sum(-1, keepdims=True)
    product: Turns = np.concatenate([w, a * v + b * u + np.cross(u, v)], axis=-1)
    return product


def turned(turns: Turns, vectors: Vector) -> NDArray[np.float64]:
    """Vectors (..., 3) after the turns."""
    w, u = turns[..., :1], turns[..., 1:]
    twice = 2.0 * np.cross(u, vectors)
    result: NDArray[np.float64] = vectors + w * twice + np.cross(u, twice)
    return result


def arc(start: Vector, ends: NDArray[np.float64]) -> Turns:
    """The shortest turns that lead a direction (3,) to directions (n, 3): they twist nothing."""
    a = start / np.linalg.norm(start)
    b = ends / np.maximum(np.linalg.norm(ends, axis=-1, keepdims=True), OPPOSITE)
    w = 1.0 + b @ a
    axis = np.cross(a, b)
    aside = np.cross(a, np.eye(3)[np.abs(a).argmin()])
    opposite = w < OPPOSITE
    q = np.concatenate([np.where(opposite, 0.0, w)[:, None], axis], axis=1)
    q[opposite, 1:] = aside
    unit: Turns = q / np.linalg.norm(q, axis=1, keepdims=True)
    return unit


def frame_of(
    up: NDArray[np.float64], across: NDArray[np.float64], keep: Literal["up", "across"] = "up"
) -> Turns:
    """The turns that lead +y to `up` and +x to `across`, (n, 4).

    Args:
        up: (n, 3).
        across: (n, 3), not parallel to it.
        keep: Which of the two is met exactly; the other is made square to it.
    """
    out = np.cross(across, up)
    x, y = (np.cross(up, out), up) if keep == "up" else (across, np.cross(out, across))
    axes = np.stack([x, y, out], axis=-1)
    return quaternions(axes / np.linalg.norm(axes, axis=-2, keepdims=True))


def quaternions(matrices: NDArray[np.float64]) -> Turns:
    """Rotation matrices (n, 3, 3) as quaternions.

    The matrix tells 4 q q^T; its row with the largest diagonal entry is a multiple of q that no
    rounding can spoil.
    """
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(matrices, 0, -1)
    products = np.stack(
        [
            np.stack([1 + a + e + i, h - f, c - g, d - b], -1),
            np.stack([h - f, 1 + a - e - i, d + b, c + g], -1),
            np.stack([c - g, d + b, 1 - a + e - i, h + f], -1),
            np.stack([d - b, c + g, h + f, 1 - a - e + i], -1),
        ],
        axis=-2,
    )
    largest = np.diagonal(products, axis1=-2, axis2=-1).argmax(-1)
    rows = np.take_along_axis(products, largest[:, None, None], axis=1)[:, 0]
    unit: Turns = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    return unit


def slerp(first: Turns, second: Turns, share: Any) -> Turns:
    """Turns on the way from one to the other at even speed, the shorter way round (T23).

    Args:
        first: (..., 4).
        second: As `first`.
        share: In [0, 1], (...).
    """
    share = np.asarray(share, float)[..., None]
    cosine = (first * second).sum(-1, keepdims=True)
    near = np.where(cosine < 0.0, -second, second)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    sine = np.sin(angle)
    small = sine < 1e-9
    safe = np.where(small, 1.0, sine)
    one = np.where(small, 1.0 - share, np.sin((1.0 - share) * angle) / safe)
    other = np.where(small, share, np.sin(share * angle) / safe)
    mixed = one * first + other * near
    unit: Turns = mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)
    return unit


def euler_zxy_deg(turns: Turns) -> NDArray[np.float64]:
    """Angles (n, ..., 3) about z, x, y with R = R_z R_x R_y, without jumps along the first axis.

    Of the two triples of a turn, and all that differ by full circles, the one next to the frame
    before is taken: programs that draw curves between frames would else spin a limb round.
    """
    w, x, y, z = np.moveaxis(turns, -1, 0)
    tilt = np.degrees(np.arcsin(np.clip(2 * (y * z + w * x), -1.0, 1.0)))
    about_z = np.degrees(np.arctan2(-2 * (x * y - w * z), 1 - 2 * (x * x + z * z)))
    about_y = np.degrees(np.arctan2(-2 * (x * z - w * y), 1 - 2 * (x * x + y * y)))
    angles = np.stack([about_z, tilt, about_y], axis=-1)
    for i in range(1, len(angles)):
        angles[i] = _nearest(angles[i], angles[i - 1])
    return angles


def _nearest(angles_deg: NDArray[np.float64], before_deg: NDArray[np.float64]) -> Any:
    """Of the triples (..., 3) that mean one turn, those next to others."""
    flipped = np.stack(
        [angles_deg[..., 0] + 180.0, 180.0 - angles_deg[..., 1], angles_deg[..., 2] + 180.0], -1
    )
    both = np.stack([angles_deg, flipped])
    both = both + 360.0 * np.rint((before_deg - both) / 360.0)
    cost = np.abs(both - before_deg).sum(-1)
    return np.where((cost[0] <= cost[1])[..., None], both[0], both[1])
