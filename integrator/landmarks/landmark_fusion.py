"""One body of what the outlines propose and what each view's picture shows of the joints."""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.compiled import compiled
from integrator.landmarks import (
    front_back_flip,
    left_right_swap,
    limb_springs,
    proposal_offset,
    proposal_residual,
)
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
from integrator.landmarks.left_right_swap import Exchanged, Exchanges
from integrator.landmarks.proposal_residual import Misfit
from integrator.proposal import pose_network
from integrator.proposal.network_weights import JOINTS
from integrator.proposal.pose_network import OTHER_SIDES

ARMS, LEGS = slice(0, 6), slice(6, 12)
"""Of JOINTS."""
PROPOSED_RIGHT: Final = (0.18, 0.9)
"""Confidence in a proposed joint at which it is never, and always, taken for right."""
SHOWN_RIGHT: Final = (0.02, 0.91)
"""Likewise of a landmark."""
FIRM_M: Final = 0.02
PLATT: Final = (2.15, 4.25)
"""The logit of the confidence in a joint whose standard deviation is FIRM_M, and how much it falls
as that grows by e times: how often joints of r01, r04 and made-up people were less than 50 mm off.
"""
_DIAGONAL: Final = [0, 3, 5]


class Memory(NamedTuple):
    """What is remembered between instants."""

    turned: tuple[float, bool]
    """How probably proposals are turned about, and whether they are taken for it."""
    exchanges: Exchanges
    lengths_m: Vector
    """(10,) of `limb_springs.ENDS`."""
    misfit: Misfit
    """How far proposals were beside the rays."""
    displaced: Vector
    """(4,) how far proposals stood beside them as a whole."""


class Proposal(NamedTuple):
    """The joints that outlines propose, and how far to believe them."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    confidence: Vector
    """(12,) how probably each is less than 50 mm off."""
    wider_m: Vector
    """(12,) by how much their spreads grow."""
    often: float
    """How often they are roughly right, where they are not right."""


class Fused(NamedTuple):
    """The joints of an instant."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    confidence: Vector
    """(12,) how probably each is less than 50 mm off."""
    exchanged: Exchanged
    memory: Memory


def step(
    before: Memory | None,
    proposed_m: NDArray[np.float64],
    confidence: Vector,
    rays: Rays,
    stature_m: float,
) -> Fused:
    """One instant: each joint where the proposal and both views together most probably have it.

    Where faces say that the proposal is turned about, its sides are exchanged. Where proposals have
    lately been off what is shown, they are believed less closely and less surely; where they have
    been so as a whole, they are moved. Which sides a view exchanged is decided for arms and legs as
    wholes, by all that is said of their joints; then limbs are given their lengths.

    Args:
        before: Of the instant before; None at the first.
        proposed_m: (12, 3) world, of JOINTS.
        confidence: (12,) how probably each is less than 50 mm off.
        rays: Of both views' landmarks.
        stature_m: Of the person.
    """
    turned = front_back_flip.step(None if before is None else before.turned, proposed_m, rays)
    if turned[1]:
        proposed_m, confidence = proposed_m[OTHER_SIDES], confidence[OTHER_SIDES]
    misfit = proposal_residual.step(
        None if before is None else before.misfit, proposed_m, rays, stature_m
    )
    wider_m = proposal_residual.wider_m(misfit, rays, stature_m)
    doubt = proposal_residual.doubt(misfit, turned[1])
    displaced, proposed_m = proposal_offset.step(
        None if before is None else before.displaced, proposed_m, _shown(rays), rays, stature_m
    )
    values, places_m, precisions = _weighed(
        Proposal(proposed_m, _doubted(confidence, doubt), wider_m, _doubted(PROPOSED.often, doubt)),
        rays,
        stature_m,
    )
    exchanges, decided = left_right_swap.step(
        None if before is None else before.exchanges,
        values[ARMS].sum(axis=0),
        values[LEGS].sum(axis=0),
        _aside(proposed_m, rays.centres_m),
        _confused(rays),
    )
    joints_m = np.concatenate([places_m[(ARMS, *decided.arms)], places_m[(LEGS, *decided.legs)]])
    tight = np.concatenate([precisions[(ARMS, *decided.arms)], precisions[(LEGS, *decided.legs)]])
    lengths_m = None if before is None else before.lengths_m
    if lengths_m is not None:
        joints_m = limb_springs.sprung(joints_m, tight, lengths_m)
    lengths_m = limb_springs.lengths_m(lengths_m, joints_m, stature_m)
    memory = Memory(turned, exchanges, lengths_m, misfit, displaced)
    return Fused(joints_m, _confidence(tight), decided, memory)


def _weighed(
    proposal: Proposal, rays: Rays, stature_m: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """`_modes` of what confidences say of how sure and how wide each witness is."""
    shown = _shown(rays)
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
    )
    return found


def _shown(rays: Rays) -> NDArray[np.float64]:
    """(2, 12) how probably each landmark is right; 0: there is none."""
    return np.where(rays.confidence > 0.0, _share(rays.confidence, SHOWN_RIGHT), 0.0)


def _confidence(precisions: NDArray[np.float64]) -> Vector:
    """How probably joints are less than 50 mm off, of how tightly they are held, (12, 6)."""
    spreads_m = np.sqrt(3.0 / precisions[:, _DIAGONAL].sum(axis=1))
    certain, steep = PLATT
    found: Vector = 1.0 / (1.0 + np.exp(-certain) * (spreads_m / FIRM_M) ** steep)
    return found


def _doubted(probability: Any, doubt: float) -> Any:
    """A probability, or some, by odds that are so many times lower."""
    return probability / (probability + doubt * (1.0 - probability))


def _share(confidence: Vector, between: tuple[float, float]) -> Vector:
    never, always = between
    found: Vector = ((confidence - never) / (always - never)).clip(LEAST, MOST)
    return found


def _aside(joints_m: NDArray[np.float64], centres_m: NDArray[np.float64]) -> tuple[float, float]:
    """How far each camera sees a profile, in [0, 1]."""
    lefts, rights = joints_m[0::2], joints_m[1::2]
    girdles = [pose_network.SHOULDERS.start // 2, pose_network.HIPS.start // 2]
    across = (lefts - rights)[girdles].sum(axis=0)
    away = centres_m - joints_m.mean(axis=0)
    away[:, 1] = 0.0
    long = np.linalg.norm(away, axis=1) * np.linalg.norm(across) + 1e-9
    first, second = (np.abs(away @ across) / long).tolist()
    return first, second


def _confused(rays: Rays) -> tuple[float, float]:
    """How probably each view took front for back."""
    first, second = (front_back_flip.confused(sure) for sure in rays.facing_confidence)
    return first, second


@compiled
def _modes(
    proposed_m: Any,
    sure: Any,
    spreads_m: Any,
    roughly_m: Any,
    often: float,
    centres_m: Any,
    directions: Any,
    seen: Any,
    seen_m: Any,
    stature_m: float,
) -> tuple[Any, Any, Any]:
    """Of each joint, exchanged by view 1 and by view 2: how probable its place is, log
    (12, 2, 2), the place (12, 2, 2, 3) and its precision (12, 2, 2, 6)."""
    n = len(proposed_m)
    values, places_m = np.empty((n, 2, 2)), np.empty((n, 2, 2, 3))
    precisions = np.empty((n, 2, 2, 6))
    along, inliers, spreads = np.empty((2, BOTH, 3)), np.empty((2, BOTH)), np.empty(3)
    for joint in range(n):
        spreads[0] = spreads_m[joint]
        for first in range(2):
            for second in range(2):
                for view in range(2):
                    own = joint ^ (first if view == 0 else second)
                    along[view] = directions[view, own]
                    inliers[view] = seen[view, own]
                    spreads[1 + view] = seen_m[view, own]
                told = Evidence(
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
                values[joint, first, second] = most_probable(
                    told, places_m[joint, first, second], precisions[joint, first, second]
                )
    return values, places_m, precisions


assert len(JOINTS) == LEGS.stop
