"""One delay's fit to both views: a relation, and how far landmarks miss it."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import LEAST_SURE, JointTrack, at_times
from calibration.tracks.sight_lines import Numbers
from calibration.tracks.view_relation import Relation, relation_of, terms_of
from common.body.body import OTHER_SIDE, Vector
from common.compiled import compiled

LEAST_SHARED: Final = 12
"""Fewest moments that both views must share: fewer fit any relation."""
ERR: Final = 0.022
"""Standard deviation of landmarks about the relation, heights of the person."""
SURE: Final = 0.12
"""Confidence below which landmarks are left out."""
EXCHANGE_COST: Final = 0.5
"""Log likelihood that exchanged sides must gain for a part."""
ROUNDS: Final = 3
"""Number of rounds: each decides the exchanged sides again and weighs outliers less."""


class Fit(NamedTuple):
    """The moments under one delay."""

    late_s: float
    costs: Vector
    """(moments,) cost of the landmarks' misses; 0 where not both views show the person."""
    weights: Vector
    """(moments,) weights of these landmarks."""

    @property
    def miss(self) -> float:
        """Mean miss of a landmark."""
        return float(self.costs.sum() / self.weights.sum())

    @property
    def moments(self) -> int:
        """Number of moments that both views have."""
        return int(np.count_nonzero(self.weights))


class _Paired(NamedTuple):
    """Both views at the moments that they have in common."""

    terms: Numbers
    """(2, n, 15, 8): sides as they are, and exchanged in view 2."""
    weights: Numbers
    """(2, n, 15)"""


def _paired(
    first: JointTrack, second: JointTrack, late_s: float
) -> tuple[NDArray[np.bool_], _Paired]:
    """The moments that both views have, and their contents."""
    there = at_times(second, first.times_s + late_s)
    both = there.confidence.mean(axis=1) >= LEAST_SURE
    places, sure = there.joints_px[both], there.confidence[both]
    ways = [(places, sure), (places[:, OTHER_SIDE], sure[:, OTHER_SIDE])]
    weights = np.stack([np.minimum(first.confidence[both], other) for _, other in ways])
    return both, _Paired(
        np.stack([terms_of(first.joints_px[both], other) for other, _ in ways]),
        np.where(weights >= SURE, weights, 0.0),
    )


def fits_of(views: tuple[JointTrack, JointTrack], tried: list[float]) -> list[Fit]:
    """Fits of the delays that leave enough moments in common."""
    return [fit for late_s in tried if (fit := _fitted(*views, late_s))]


def _fitted(first: JointTrack, second: JointTrack, late_s: float) -> Fit | None:
    both, paired = _paired(first, second, late_s)
    if both.sum() < LEAST_SHARED or not paired.weights[0].any():
        return None
    sides, off = _in_rounds(paired.terms, paired.weights)
    costs, weights = np.zeros((2, len(both)))
    each = np.where(sides, paired.weights[1], paired.weights[0])
    costs[both] = (each * np.log1p(np.where(sides, off[1], off[0]))).sum(axis=1)
    weights[both] = each.sum(axis=1)
    return Fit(late_s, costs, weights)


@compiled
def _in_rounds(terms: Numbers, weights: Numbers) -> tuple[NDArray[np.bool_], Numbers]:
    """(n, 15) whose sides are exchanged, and (2, n, 15) half the squared misses either way, in
    units of ERR."""
    _, moments, joints, count = terms.shape
    sides, trust = np.zeros((moments, joints), np.bool_), np.ones((moments, joints))
    off, chosen = np.empty(weights.shape), np.empty((moments, joints, count))
    for _ in range(ROUNDS):
        for n in range(moments):
            for joint in range(joints):
                way = int(sides[n, joint])
                chosen[n, joint] = terms[way, n, joint]
                trust[n, joint] *= weights[way, n, joint]
        relation = relation_of(chosen.reshape(-1, count), trust.ravel())
        _set_off(off, terms, relation)
        _set_sides(sides, off, weights)
        for n in range(moments):
            for joint in range(joints):
                trust[n, joint] = 1.0 / (1.0 + off[int(sides[n, joint]), n, joint])
    return sides, off


@compiled
def _set_off(off: Numbers, terms: Numbers, relation: Relation) -> None:
    for way in range(2):
        for n in range(terms.shape[1]):
            for joint in range(terms.shape[2]):
                miss = 0.0
                for k in range(terms.shape[3]):
                    miss += (terms[way, n, joint, k] - relation.means[k]) * relation.weights[k]
                off[way, n, joint] = (miss / ERR) ** 2 / 2.0


@compiled
def _set_sides(sides: NDArray[np.bool_], off: Numbers, weights: Numbers) -> None:
    """Of each part but the trunk, by the landmarks' costs either way."""
    for n in range(len(sides)):
        costs = np.zeros((2, 3))
        for way in range(2):
            for joint, part in enumerate(prior.PART_OF_JOINT):
                costs[way, part] += weights[way, n, joint] * np.log1p(off[way, n, joint])
        for joint, part in enumerate(prior.PART_OF_JOINT):
            exchanged = costs[1, part] + EXCHANGE_COST < costs[0, part]
            sides[n, joint] = exchanged and part != prior.TRUNK
