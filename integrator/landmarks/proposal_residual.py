"""Residuals of recent proposals against the landmarks' rays, and the doubt that follows."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from integrator.landmarks.landmark_rays import Rays

USUAL: Final = 0.06
"""Usual residual of a proposal, statures: two performers' are hardly ever larger
(docs/measurements.md)."""
WIDER: Final = 2.0
"""Growth of a proposal's spread for each USUAL by which its residual is larger."""
FARTHEST: Final = 0.25
"""Residual of a landmark, statures, beyond which its influence stops growing."""
DOUBTED_FROM: Final = 0.035
"""Residual from which a proposal is doubted, statures: a third have a larger one."""
ODDS_EXPONENT: Final = 4.0
"""Exponent of a residual over DOUBTED_FROM by which the proposal's odds fall. Measured on
synthetic people before misleading backgrounds, for joints of confidence .7 to .9: at residuals
of .03, .045, .06, .08 and .1, 76, 55, 47, 29 and 11 % of them were near (docs/measurements.md)."""
TURNED: Final = 50.0
"""Factor by which the odds fall further where the proposal may have front for back: 1 % of those
were near, 60 % roughly right (docs/measurements.md)."""
EMA_WEIGHT: Final = 0.2
"""Weight in the running mean of an instant whose landmarks are all sure."""


class Misfit(NamedTuple):
    """Running mean squares of the distances from proposed joints to their rays, statures^2."""

    whole: float
    """Over all joints."""
    pairs: Vector
    """(6,) for each pair of left and right: wrists may be wrong while all else is right."""


def step(
    before: Misfit | None, proposed_m: NDArray[np.float64], rays: Rays, stature_m: float
) -> Misfit:
    """The residuals up to an instant.

    Args:
        before: The residuals up to the instant before; None at the first.
        proposed_m: (12, 3) world, of JOINTS.
        rays: Rays of the views' landmarks.
        stature_m: The person's stature.
    """
    pairs = len(proposed_m) // 2
    known = Misfit(0.0, np.zeros(pairs)) if before is None else before
    squares, weights = np.zeros((pairs, 2)), np.zeros((pairs, 2))
    for view in range(len(rays.centres_m)):
        off = _off(proposed_m - rays.centres_m[view], rays.directions[view]) / stature_m
        own, exchanged = off[0].reshape(-1, 2), off[1].reshape(-1, 2)
        nearer = (own.sum(axis=1) <= exchanged.sum(axis=1))[:, None]
        sure = rays.confidence[view].reshape(-1, 2)
        squares += sure * np.where(nearer, own, exchanged).clip(max=FARTHEST) ** 2
        weights += sure
    return Misfit(
        float(_renewed(known.whole, squares.sum(), weights.sum(), len(proposed_m))),
        _renewed(known.pairs, squares.sum(axis=1), weights.sum(axis=1), 2),
    )


def wider_m(misfit: Misfit, rays: Rays, stature_m: float) -> Vector:
    """Growth of each proposed joint's spread, (12,) metres.

    A proposal from one silhouette alone is doubted pair by pair too. For two views that makes the
    result worse: 25.0 mm instead of 23.4 (docs/measurements.md).
    """
    squares = np.full_like(misfit.pairs, misfit.whole)
    if rays.confidence.any(axis=1).sum() < 2:
        squares = np.maximum(squares, misfit.pairs)
    wider: Vector = WIDER * np.maximum(0.0, np.sqrt(squares) - USUAL) * stature_m
    return np.repeat(wider, 2)


def doubt(misfit: Misfit, turned: bool) -> float:
    """Divisor of the odds that proposed joints are right.

    Args:
        misfit: The residuals up to this instant.
        turned: Whether the proposal is flipped.
    """
    beyond = max(1.0, math.sqrt(misfit.whole) / DOUBTED_FROM)
    return (TURNED if turned else 1.0) * float(beyond**ODDS_EXPONENT)


def _renewed(before: float | Vector, squares: Vector, weights: Vector, joints: int) -> Vector:
    """A running mean, updated with the joints of one instant."""
    share = EMA_WEIGHT * np.minimum(1.0, weights / joints)
    return (1.0 - share) * before + share * squares / np.maximum(weights, 1e-9)


def _off(away_m: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, 12) distances, metres, from joints (12, 3) in camera axes to their rays and to the
    other side's."""
    sides = np.stack([directions, directions.reshape(-1, 2, 3)[:, ::-1].reshape(-1, 3)])
    along = (away_m * sides).sum(axis=2, keepdims=True)
    found: NDArray[np.float64] = np.linalg.norm(away_m - along * sides, axis=2)
    return found
