"""How far proposals have lately been off what the pictures show, and so how far to believe them."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from integrator.landmarks.landmark_rays import Rays

USUAL: Final = 0.06
"""Proposals of r01 and r04 are hardly ever farther off, in statures ..."""
WIDER: Final = 2.0
"""... and one who is farther is believed by so much less closely for each that he is."""
FARTHEST: Final = 0.25
"""A landmark that is farther off says no more than one that is so far."""
LATELY: Final = 0.2
"""Share of an instant that all its landmarks are sure of."""


def step(before: float, proposed_m: NDArray[np.float64], rays: Rays, stature_m: float) -> float:
    """The mean square of how far proposals were beside the rays, statures^2, the latest most.

    Args:
        before: Up to the instant before; 0 at the first: one instant alone proves little.
        proposed_m: (12, 3) world, of JOINTS.
        rays: Of both views' landmarks.
        stature_m: Of the person.
    """
    squares = weight = 0.0
    for view in range(2):
        off = _off(proposed_m - rays.centres_m[view], rays.directions[view]) / stature_m
        own, exchanged = off[0].reshape(-1, 2), off[1].reshape(-1, 2)
        nearer = (own.sum(axis=1) <= exchanged.sum(axis=1))[:, None]
        nearest = np.where(nearer, own, exchanged).clip(max=FARTHEST).reshape(-1)
        squares += float(rays.confidence[view] @ nearest**2)
        weight += float(rays.confidence[view].sum())
    if weight == 0.0:
        return before
    share = LATELY * min(1.0, weight / len(proposed_m))
    return (1.0 - share) * before + share * squares / weight


def wider_m(misfit: float, stature_m: float) -> float:
    """By how much the spread of a proposed joint grows, metres."""
    return WIDER * max(0.0, math.sqrt(misfit) - USUAL) * stature_m


def _off(away_m: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, 12) metres from joints, (12, 3) of the camera, to their rays and to the other side's."""
    sides = np.stack([directions, directions.reshape(-1, 2, 3)[:, ::-1].reshape(-1, 3)])
    along = (away_m * sides).sum(axis=2, keepdims=True)
    found: NDArray[np.float64] = np.linalg.norm(away_m - along * sides, axis=2)
    return found
