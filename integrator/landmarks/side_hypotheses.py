"""The most probable place of each joint for each choice of the views that exchanged sides."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.compiled import compiled
from integrator.landmarks.joint_mixture import (
    BOTH,
    LEAST,
    MOST,
    PROPOSED,
    SECOND,
    SHOWN,
    Evidence,
    most_probable,
)
from integrator.landmarks.landmark_rays import Rays

PROPOSED_RIGHT: Final = (0.18, 0.9)
"""Confidences in a proposed joint that mean probability 0 and 1 of being right."""
SHOWN_RIGHT: Final = (0.02, 0.91)
"""Confidences in a landmark that mean probability 0 and 1 of being right."""


class Proposal(NamedTuple):
    """The joints proposed by the silhouettes, and their reliability."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    confidence: Vector
    """(12,) probability that each is less than 50 mm off."""
    wider_m: Vector
    """(12,) growth of their standard deviations, metres."""
    often: float
    """Probability that one is roughly right, if it is not right."""


def weighed(
    proposal: Proposal, rays: Rays, stature_m: float, ways: NDArray[np.int_]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """`_modes` for evidence whose probability and spread follow from its confidence."""
    shown = shown_right(rays)
    others = np.where(rays.others_confidence < SECOND, 0.0, rays.others_confidence)
    confidence, wider_m = proposal.confidence, proposal.wider_m
    found: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] = _modes(
        proposal.joints_m,
        _share(confidence, PROPOSED_RIGHT),
        np.hypot(PROPOSED.right_of(confidence), wider_m),
        np.hypot(PROPOSED.roughly, wider_m),
        proposal.often,
        rays.centres_m,
        np.stack([rays.directions, rays.others], axis=2),
        np.stack([shown, np.minimum(others, MOST - shown)], axis=2),
        stature_m * SHOWN.right_of(rays.confidence),
        stature_m,
        ways,
    )
    return found


def shown_right(rays: Rays) -> NDArray[np.float64]:
    """(V, 12) probability that each landmark is right; 0: there is none."""
    return np.where(rays.confidence > 0.0, _share(rays.confidence, SHOWN_RIGHT), 0.0)


def _share(confidence: Vector, between: tuple[float, float]) -> Vector:
    never, always = between
    found: Vector = ((confidence - never) / (always - never)).clip(LEAST, MOST)
    return found


@compiled
def _modes(
    proposed_m: Floats,
    sure: Vector,
    spreads_m: Vector,
    roughly_m: Vector,
    often: float,
    centres_m: Floats,
    directions: Floats,
    seen: Floats,
    seen_m: Floats,
    stature_m: float,
    ways: NDArray[np.int64],
) -> tuple[Floats, Floats, Floats]:
    """For each joint and each choice of views with exchanged sides: the log probability of its
    place (12, S), the place (12, S, 3) and its precision (12, S, 6).

    Args:
        proposed_m: (12, 3)
        sure: (12,) probability that each is right, and
        spreads_m, roughly_m: (12,) its standard deviation if right, or if roughly right.
        often: Probability that it is roughly right, if it is not right.
        centres_m: (V, 3) the cameras.
        directions: (V, 12, BOTH, 3) directions of their rays.
        seen: (V, 12, BOTH) probability that each ray is right; 0: there is none.
        seen_m: (V, 12) standard deviation of a right ray.
        stature_m: The person's stature.
        ways: (2, S, V) exchanges of arms and of legs; 1: that view exchanged them.
    """
    n, views, joints_of_part = len(proposed_m), len(centres_m), len(proposed_m) // 2
    values, places_m = np.empty((n, ways.shape[1])), np.empty((n, ways.shape[1], 3))
    precisions = np.empty((n, ways.shape[1], 6))
    along, inliers = np.empty((views, BOTH, 3)), np.empty((views, BOTH))
    spreads = np.empty(1 + views)
    for joint in range(n):
        spreads[0] = spreads_m[joint]
        for way in range(ways.shape[1]):
            for view in range(views):
                own = joint ^ ways[joint // joints_of_part, way, view]
                along[view] = directions[view, own]
                inliers[view] = seen[view, own]
                spreads[1 + view] = seen_m[view, own]
            given = Evidence(
                proposed_m[joint],
                sure[joint],
                centres_m,
                along,
                inliers,
                spreads,
                roughly_m[joint],
                often,
                stature_m,
            )
            values[joint, way] = most_probable(given, places_m[joint, way], precisions[joint, way])
    return values, places_m, precisions
