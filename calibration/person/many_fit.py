"""One joint adjustment of all cameras: the pairs' residuals together."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from calibration.person.many_guess import FIXED, Layout, Pair, pair_guess
from calibration.person.rig_evidence import Evidence, Sides
from calibration.person.rig_fit import in_rounds, sides_of
from calibration.person.rig_residuals import observed_misfits, prior_misfits
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector

Pairs = Mapping[Pair, Evidence]


class ManyFit(NamedTuple):
    """The result of a fit."""

    guess: Vector
    cost: float
    sides: dict[Pair, tuple[Sides, ...]]
    jacobian: Numbers
    """(residuals, guess) Jacobian; 0 for what is fixed."""


def many_fitted(start: Vector, layout: Layout, pairs: Pairs, rounds: int, steps: int) -> ManyFit:
    """The best vector near a start, by the objective of two cameras summed over the pairs.

    Of N views a landmark tells 2 N - 3 numbers, one of each pair of the N (N - 1) / 2 as many as
    two views: a pair counts for its share of them. The prior on a camera counts once.

    Args:
        start: A vector.
        layout: Of the vector.
        pairs: The data of each pair.
        rounds: How often the exchanged sides are decided again.
        steps: Iterations of the fit in each round.
    """
    free = np.setdiff1d(np.arange(layout.size), FIXED)
    found, sides, own = in_rounds(
        start,
        free,
        (
            lambda guess: many_sides(guess, layout, pairs),
            lambda guess, at: many_misfits(guess, layout, pairs, at),
        ),
        rounds,
        steps,
    )
    jacobian = np.zeros((len(own), layout.size))
    jacobian[:, free] = own
    return ManyFit(found.guess, found.cost, sides, jacobian)


def many_sides(guess: Vector, layout: Layout, pairs: Pairs) -> dict[Pair, tuple[Sides, ...]]:
    """Of each pair, where one view's sides must be exchanged."""
    return {
        pair: sides_of(pair_guess(layout, guess, pair), evidence)
        for pair, evidence in pairs.items()
    }


def many_misfits(
    guess: Vector, layout: Layout, pairs: Pairs, sides: Mapping[Pair, tuple[Sides, ...]]
) -> Vector:
    """All residuals."""
    count = layout.cameras
    data = math.sqrt((2 * count - 3) / max(len(pairs), 1))
    prior = math.sqrt(count / (2 * max(len(pairs), 1)))
    rows = []
    for pair, evidence in pairs.items():
        own = pair_guess(layout, guess, pair)
        rows += [prior * row for row in prior_misfits(own, evidence.known)]
        rows += [data * row for row in observed_misfits(own, evidence, sides[pair])]
    return np.concatenate(rows)
