"""The joints of an instant, fused from the silhouettes' proposal and all views' landmarks."""

from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
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
from integrator.landmarks.left_right_swap import JOINTLY, Exchanged, Exchanges
from integrator.landmarks.proposal_residual import Misfit
from integrator.proposal import pose_network
from integrator.proposal.network_weights import JOINTS
from integrator.proposal.pose_network import OTHER_SIDES

ARMS, LEGS = slice(0, 6), slice(6, 12)
"""Indices of the arms and the legs in JOINTS."""
PROPOSED_RIGHT: Final = (0.18, 0.9)
"""Confidences in a proposed joint that mean probability 0 and 1 of being right."""
SHOWN_RIGHT: Final = (0.02, 0.91)
"""Confidences in a landmark that mean probability 0 and 1 of being right."""
FIRM_M: Final = 0.02
PLATT: Final = (2.15, 4.25)
"""Platt scaling of a joint's confidence: its logit at a standard deviation of FIRM_M, and the fall
where the deviation grows e-fold. Fitted to joints less than 50 mm off (docs/measurements.md)."""
Probability = TypeVar("Probability", float, Vector)
_DIAGONAL: Final = [0, 3, 5]


class Memory(NamedTuple):
    """Memory between instants."""

    turned: tuple[float, bool]
    """Probability that proposals have front for back, and whether they are flipped."""
    exchanges: Exchanges
    exchanged: Exchanged
    """Posterior of the exchanged sides."""
    lengths_m: Vector
    """(10,) lengths of `limb_springs.ENDS`."""
    misfit: Misfit
    """Residuals of recent proposals against the rays."""
    displaced: Vector
    """(4,) common offset of recent proposals from the rays."""


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


class Fused(NamedTuple):
    """The joints of an instant."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    confidence: Vector
    """(12,) probability that each is less than 50 mm off."""
    exchanged: Exchanged
    memory: Memory


def step(
    before: Memory | None,
    proposed_m: NDArray[np.float64],
    confidence: Vector,
    rays: Rays,
    stature_m: float,
) -> Fused:
    """One instant: each joint at its most probable place by the proposal and all views.

    A proposal with front for back, by the views' facings, gets its sides exchanged. Proposals whose
    recent residuals are large get a wider spread and less confidence; an offset that all their
    joints share is subtracted. Whether a view exchanged left and right is decided for the arms as a
    whole and for the legs as a whole. Then limbs are pulled to their lengths.

    Args:
        before: The memory of the instant before; None at the first.
        proposed_m: (12, 3) world, of JOINTS.
        confidence: (12,) probability that each is less than 50 mm off.
        rays: Rays of the views' landmarks.
        stature_m: The person's stature.
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
    proposal = Proposal(
        proposed_m, _doubted(confidence, doubt), wider_m, _doubted(PROPOSED.often, doubt)
    )
    exchanges, decided, joints_m, tight = _with_own_sides(before, proposal, rays, stature_m)
    lengths_m = None if before is None else before.lengths_m
    if lengths_m is not None:
        joints_m = limb_springs.sprung(joints_m, tight, lengths_m)
    lengths_m = limb_springs.lengths_m(lengths_m, joints_m, stature_m)
    memory = Memory(turned, exchanges, decided, lengths_m, misfit, displaced)
    return Fused(joints_m, _confidence(tight), decided, memory)


def _with_own_sides(
    before: Memory | None, proposal: Proposal, rays: Rays, stature_m: float
) -> tuple[Exchanges, Exchanged, NDArray[np.float64], NDArray[np.float64]]:
    """The sides that each view exchanged, and the resulting joints (12, 3) with their precision."""
    views = len(rays.centres_m)
    known = None if before is None else before.exchanges
    usual = (_aside(proposal.joints_m, rays.centres_m), _confused(rays))
    if views <= JOINTLY:
        all_ways = np.indices((2,) * views).reshape(views, -1).T
        values, places_m, precisions = _weighed(
            proposal, rays, stature_m, np.stack([all_ways, all_ways])
        )
        arms, legs = (values[part].sum(axis=0).reshape((2,) * views) for part in (ARMS, LEGS))
        exchanges, decided = left_right_swap.step(known, arms, legs, *usual)
        at = [int(np.ravel_multi_index(part, (2,) * views)) for part in decided]
    else:
        was = np.zeros((2, views), int) if before is None else np.array(before.exchanged)
        one_way = was[:, None] ^ np.concatenate(
            [np.zeros((1, views), int), np.eye(views, dtype=int)]
        )
        values, _, _ = _weighed(proposal, rays, stature_m, one_way)
        arms, legs = (
            _each_way(values[part].sum(axis=0), own)
            for part, own in zip((ARMS, LEGS), was, strict=True)
        )
        exchanges, decided = left_right_swap.step_each(known, arms, legs, *usual)
        _, places_m, precisions = _weighed(proposal, rays, stature_m, np.array(decided)[:, None])
        at = [0, 0]
    joints_m = np.concatenate([places_m[ARMS, at[0]], places_m[LEGS, at[1]]])
    return (
        exchanges,
        decided,
        joints_m,
        np.concatenate([precisions[ARMS, at[0]], precisions[LEGS, at[1]]]),
    )


def _each_way(values: Vector, was: NDArray[np.int_]) -> NDArray[np.float64]:
    """(V, 2) log likelihood of each view not exchanged and exchanged, the others as they were.

    Args:
        values: (1 + V,) all as they were, and with each view's changed.
        was: (V,) previous decisions; 1: exchanged.
    """
    both = np.stack([np.full(len(was), values[0]), values[1:]], axis=1)
    return np.where(was[:, None] == 1, both[:, ::-1], both)


def _weighed(
    proposal: Proposal, rays: Rays, stature_m: float, ways: NDArray[np.int_]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """`_modes` for evidence whose probability and spread follow from its confidence."""
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
        ways,
    )
    return found


def _shown(rays: Rays) -> NDArray[np.float64]:
    """(V, 12) probability that each landmark is right; 0: there is none."""
    return np.where(rays.confidence > 0.0, _share(rays.confidence, SHOWN_RIGHT), 0.0)


def _confidence(precisions: NDArray[np.float64]) -> Vector:
    """Probability that joints are less than 50 mm off, by their precisions (12, 6)."""
    spreads_m = np.sqrt(3.0 / precisions[:, _DIAGONAL].sum(axis=1))
    certain, steep = PLATT
    found: Vector = 1.0 / (1.0 + np.exp(-certain) * (spreads_m / FIRM_M) ** steep)
    return found


def _doubted(probability: Probability, doubt: float) -> Probability:
    """A probability, or some, whose odds are divided by `doubt`."""
    return probability / (probability + doubt * (1.0 - probability))


def _share(confidence: Vector, between: tuple[float, float]) -> Vector:
    never, always = between
    found: Vector = ((confidence - never) / (always - never)).clip(LEAST, MOST)
    return found


def _aside(joints_m: NDArray[np.float64], centres_m: NDArray[np.float64]) -> tuple[float, ...]:
    """How much each camera sees a profile: 0 front or back, 1 profile."""
    lefts, rights = joints_m[0::2], joints_m[1::2]
    girdles = [pose_network.SHOULDERS.start // 2, pose_network.HIPS.start // 2]
    across = (lefts - rights)[girdles].sum(axis=0)
    away = centres_m - joints_m.mean(axis=0)
    away[:, 1] = 0.0
    long = np.linalg.norm(away, axis=1) * np.linalg.norm(across) + 1e-9
    return tuple((np.abs(away @ across) / long).tolist())


def _confused(rays: Rays) -> tuple[float, ...]:
    """Probability that each view took front for back."""
    return tuple(front_back_flip.confused(sure) for sure in rays.facing_confidence)


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


assert len(JOINTS) == LEGS.stop
