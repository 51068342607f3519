"""Partial turns of a bone, turns about one axis, and turns into a hanging pose."""

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

Turns = NDArray[np.float64]
"""(n, 3, 3) rotations."""


def between(one: Turns, other: Turns, share: float) -> Turns:
    """A share of the shortest turn from one rotation to another."""
    return np.asarray(one @ _partly(np.swapaxes(one, 1, 2) @ other, share))


def about(axis: Vector, angle_deg: Vector) -> Turns:
    """Right-handed turns by angles (n,) about one axis (3,) of any length."""
    unit = axis / np.linalg.norm(axis)
    return _turned(np.tile(unit, (len(angle_deg), 1)), np.radians(angle_deg))


def hanging(limb: Vector, hinge: Vector) -> NDArray[np.float64]:
    """The turn (3, 3) that makes a limb (3,) hang down, with its joint's axis (3,) along x."""
    up = -limb / np.linalg.norm(limb)
    x = hinge - (hinge @ up) * up
    x /= np.linalg.norm(x)
    return np.stack([x, up, np.cross(x, up)])


def raised_deg(arm: Turns) -> Vector:
    """Elevation of a limb that hangs at the identity turn, (n,)."""
    return np.asarray(np.degrees(np.arccos(np.clip(arm[:, 1, 1], -1.0, 1.0))))


def _partly(turns: Turns, share: float) -> Turns:
    cosine = np.clip((np.trace(turns, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)
    axis = np.stack([turns[:, k, j] - turns[:, j, k] for j, k in ((1, 2), (2, 0), (0, 1))], axis=1)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True) + 1e-12
    return _turned(axis, share * np.arccos(cosine))


def _turned(axis: NDArray[np.float64], angle: Vector) -> Turns:
    """By angles (n,) in radians about unit axes (n, 3). Source: Rodrigues' formula."""
    cross = np.zeros((len(axis), 3, 3))
    for j, k, m in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[:, k, j], cross[:, j, k] = axis[:, m], -axis[:, m]
    sine, rest = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + rest * (cross @ cross))
