"""How far proposals have lately been off what the pictures show, and so how far to believe them."""

from typing import Final, NamedTuple

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


class Misfit(NamedTuple):
    """Of the instants up to now, the latest most."""

    squares: float = 0.0
    """Sum of weighted squares, statures^2, ..."""
    weight: float = 0.0
    """... and of the weights."""

    @property
    def off(self) -> float:
        """How far proposals were beside the rays, statures."""
        return float(np.sqrt(self.squares / self.weight)) if self.weight > 0.0 else 0.0


def step(
    before: Misfit | None, proposed_m: NDArray[np.float64], rays: Rays, stature_m: float
) -> Misfit:
    """With one more instant.

    Args:
        before: Of the instants before; None at the first.
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
    before = before or Misfit()
    if weight == 0.0:
        return before
    share = LATELY * min(1.0, weight / len(proposed_m))
    return Misfit(
        (1.0 - share) * before.squares + share * squares / weight,
        (1.0 - share) * before.weight + share,
    )


def wider_m(misfit: Misfit, stature_m: float) -> float:
    """By how much the spread of a proposed joint grows, metres."""
    return WIDER * max(0.0, misfit.off - USUAL) * stature_m


def _off(away_m: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, 12) metres from joints, (12, 3) of the camera, to their rays and to the other side's."""
    sides = np.stack([directions, directions.reshape(-1, 2, 3)[:, ::-1].reshape(-1, 3)])
    along = (away_m * sides).sum(axis=2, keepdims=True)
    found: NDArray[np.float64] = np.linalg.norm(away_m - along * sides, axis=2)
    return found
