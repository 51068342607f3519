"""The joints of an instant, fused from the silhouettes' proposal and all views' landmarks."""

from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.body.joint_spread import confidence_of
from integrator.landmarks import (
    front_back_flip,
    left_right_swap,
    limb_springs,
    proposal_offset,
    proposal_residual,
)
from integrator.landmarks.joint_mixture import PROPOSED
from integrator.landmarks.landmark_rays import Rays
from integrator.landmarks.left_right_swap import JOINTLY, Exchanged, Exchanges
from integrator.landmarks.proposal_residual import Misfit
from integrator.landmarks.side_hypotheses import Proposal, shown_right, weighed
from integrator.proposal import pose_network
from integrator.proposal.network_weights import JOINTS
from integrator.proposal.pose_network import OTHER_SIDES

ARMS, LEGS = slice(0, 6), slice(6, 12)
"""Indices of the arms and the legs in JOINTS."""
ASTRAY: Final = 0.25
"""Growth of a proposal's spread, statures, where the views' facings deny its yaw altogether: its
joints are wrong together, by about a trunk's breadth."""
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
    joints_m: NDArray[np.float64]
    """(12, 3) the joints."""


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
        rays: Rays of the views' landmarks, through the joints' centres.
        stature_m: The person's stature.
    """
    turned = front_back_flip.step(None if before is None else before.turned, proposed_m, rays)
    if turned[1]:
        proposed_m, confidence = proposed_m[OTHER_SIDES], confidence[OTHER_SIDES]
    misfit = proposal_residual.step(
        None if before is None else before.misfit, proposed_m, rays, stature_m
    )
    contradicted = front_back_flip.contradicted(proposed_m, rays)
    wider_m = proposal_residual.wider_m(misfit, rays, stature_m)
    wider_m += ASTRAY * stature_m * (1.0 - 1.0 / contradicted)
    doubt = proposal_residual.doubt(misfit, turned[1]) * contradicted
    displaced, proposed_m = proposal_offset.step(
        None if before is None else before.displaced, proposed_m, shown_right(rays), rays, stature_m
    )
    proposal = Proposal(
        proposed_m, _doubted(confidence, doubt), wider_m, _doubted(PROPOSED.often, doubt)
    )
    exchanges, decided, joints_m, tight = _with_own_sides(before, proposal, rays, stature_m)
    lengths_m = None if before is None else before.lengths_m
    if lengths_m is not None:
        joints_m = limb_springs.sprung(joints_m, tight, lengths_m)
    lengths_m = limb_springs.lengths_m(lengths_m, joints_m, stature_m)
    memory = Memory(turned, exchanges, decided, lengths_m, misfit, displaced, joints_m)
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
        values, places_m, precisions = weighed(
            proposal, rays, stature_m, np.stack([all_ways, all_ways])
        )
        arms, legs = (values[part].sum(axis=0).reshape((2,) * views) for part in (ARMS, LEGS))
        faced = front_back_flip.faced(places_m, all_ways, rays).reshape((2,) * (2 * views))
        exchanges, decided = left_right_swap.step(known, arms, legs, *usual, faced)
        at = [int(np.ravel_multi_index(part, (2,) * views)) for part in decided]
    else:
        was = np.zeros((2, views), int) if before is None else np.array(before.exchanged)
        one_way = was[:, None] ^ np.concatenate(
            [np.zeros((1, views), int), np.eye(views, dtype=int)]
        )
        values, _, _ = weighed(proposal, rays, stature_m, one_way)
        arms, legs = (
            _each_way(values[part].sum(axis=0), own)
            for part, own in zip((ARMS, LEGS), was, strict=True)
        )
        exchanges, decided = left_right_swap.step_each(known, arms, legs, *usual)
        _, places_m, precisions = weighed(proposal, rays, stature_m, np.array(decided)[:, None])
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


def _confidence(precisions: NDArray[np.float64]) -> Vector:
    """Probability that joints are less than 50 mm off, by their precisions (12, 6)."""
    spreads_m = np.sqrt(3.0 / precisions[:, _DIAGONAL].sum(axis=1))
    return confidence_of(spreads_m)


def _doubted(probability: Probability, doubt: float) -> Probability:
    """A probability, or some, whose odds are divided by `doubt`."""
    return probability / (probability + doubt * (1.0 - probability))


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


assert len(JOINTS) == LEGS.stop
