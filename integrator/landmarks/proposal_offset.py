"""The common offset of a proposal's joints from the views' rays, and its correction.

A silhouette with the edge of a curtain, or without one side of the body, moves or turns the whole
proposal, while the network's confidence stays. Errors of landmarks are not common to all joints.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from integrator.landmarks.joint_mixture import SHOWN
from integrator.landmarks.landmark_rays import Rays

USUAL: Final = np.array([0.015, 0.015, 0.015, math.radians(3.0)])
"""Offset and turn of proposals where only landmarks err, metres and radians. In 95 % of two
performers' instants the offset is at most 1.5 times that, the turn about twice
(docs/measurements.md)."""
SURELY: Final = 1.5
"""Offset up to which a proposal is not changed, in units of USUAL; what exceeds it is
subtracted."""
EMA_WEIGHT: Final = 0.3
"""Weight of an instant in the running mean of the offsets."""
OUTLYING: Final = 4.0
"""Residual at which a landmark's weight is halved, in its standard deviations: it may be an
outlier."""
ROUNDS: Final = 3
"""Rounds of weighted least squares."""
LOOSELY: Final = np.diag([10.0, 10.0, 10.0, 4.0])
"""Precision of an offset of zero, 1 / m^2 and 1 / radian^2, for what the rays leave
undetermined."""


def step(
    before: Vector | None,
    proposed_m: NDArray[np.float64],
    sure: NDArray[np.float64],
    rays: Rays,
    stature_m: float,
) -> tuple[Vector, NDArray[np.float64]]:
    """The running mean of the offsets, and the proposal of an instant without it.

    Args:
        before: (4,) up to the instant before: to the rays by x, y and z in metres, and about the
            vertical in radians; None at the first.
        proposed_m: (12, 3) world, of JOINTS.
        sure: (V, 12) probability that each landmark is right; 0: there is none.
        rays: Rays of the views' landmarks.
        stature_m: The person's stature.
    """
    moves = _moves(proposed_m)
    now = _displaced(moves, proposed_m, sure, rays, stature_m)
    lately = EMA_WEIGHT * now + (0.0 if before is None else (1.0 - EMA_WEIGHT) * before)
    off = float(np.linalg.norm(lately / USUAL))
    back = lately * max(0.0, 1.0 - SURELY / max(off, SURELY))
    return lately, proposed_m + moves @ back


def _moves(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(12, 3, 4) derivatives of the joints with respect to x, y and z, and to a turn about the
    vertical."""
    moves = np.zeros((len(joints_m), 3, 4))
    moves[:, :, :3] = np.eye(3)
    away_m = joints_m - joints_m.mean(axis=0)
    moves[:, 0, 3], moves[:, 2, 3] = away_m[:, 2], -away_m[:, 0]
    return moves


def _displaced(
    moves: NDArray[np.float64],
    proposed_m: NDArray[np.float64],
    sure: NDArray[np.float64],
    rays: Rays,
    stature_m: float,
) -> Vector:
    """(4,) the offset that brings a proposal nearest to the views' rays; a single view leaves it
    undetermined."""
    if sure.any(axis=1).sum() < 2:
        return np.zeros(4)
    along = rays.directions
    away_m = proposed_m - rays.centres_m[:, None]
    off_m = away_m - along * (along * away_m).sum(axis=2, keepdims=True)
    aside = moves - along[..., None] * (along[..., None, :] @ moves)
    spreads_m = stature_m * SHOWN.right_of(rays.confidence)
    found = np.zeros(4)
    for _ in range(ROUNDS):
        squares = ((off_m + aside @ found) ** 2).sum(axis=2)
        weights = sure / (spreads_m**2 + squares / OUTLYING**2)
        pulls = (aside * weights[..., None, None]).reshape(-1, 4).T
        normal = pulls @ aside.reshape(-1, 4) + LOOSELY
        found = -np.linalg.solve(normal, pulls @ off_m.ravel())
    return found
