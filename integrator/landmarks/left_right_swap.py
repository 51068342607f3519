"""Whether a view took left for right: of the arms, of the legs, or of both."""

from typing import Any, Final, NamedTuple

import numpy as np

from common.body.body import Vector

PART: Final = 0.005
"""How often a view has arms or legs alone exchanged, of somebody who faces it ..."""
PART_ASIDE: Final = 0.08
"""... and of somebody whom it sees in profile, where the limbs of both sides overlap: there arms
are in 3 to 9 % of made-up people's and legs in 9 to 14 ..."""
BOTH_ASIDE: Final = 0.05
"""... and so often both; of a front, as often as front is taken for back."""
ANEW: Final = 0.33
"""How often what was so at one instant is decided anew at the next."""
TRUST: Final = 0.67
"""How much of what an instant says is believed: its joints go wrong together."""

Exchanges = Vector
"""(2, 2, 2, 2) how probably arms are exchanged by view 1, by view 2, and legs likewise."""


class Exchanged(NamedTuple):
    """Who took left for right."""

    arms: tuple[int, int]
    """By views 1 and 2; 1: it did."""
    legs: tuple[int, int]


def step(
    before: Exchanges | None,
    arms: Vector,
    legs: Vector,
    aside: tuple[float, float],
    confused: tuple[float, float],
) -> tuple[Exchanges, Exchanged]:
    """One instant of a hidden Markov model whose 16 states are all that may be exchanged.

    Args:
        before: At the instant before; None at the first.
        arms: (2, 2) log probability of all the arms' joints, exchanged by view 1 and by view 2.
        legs: (2, 2) of the legs'.
        aside: Of each view, from 0 (it sees front or back) to 1 (a profile).
        confused: Of each view, how probably it took front for back.
    """
    first, second = (_usual(*each) for each in zip(aside, confused, strict=True))
    if before is None:
        expected: Any = np.einsum("ac,bd->abcd", first, second)
    else:
        expected = _drawn_anew(before, first[:, None, :, None], (0, 2))
        expected = _drawn_anew(expected, second[None, :, None, :], (1, 3))
    said = arms[:, :, None, None] + legs[None, None]
    now = expected * np.exp(TRUST * (said - said.max()))
    now /= now.sum()
    arms_1, arms_2, legs_1, legs_2 = (int(i) for i in np.unravel_index(now.argmax(), now.shape))
    return now, Exchanged((arms_1, arms_2), (legs_1, legs_2))


def _drawn_anew(known: Exchanges, usual: Vector, view: tuple[int, int]) -> Exchanges:
    """What is expected next where now and then the axes of one view are drawn from the usual."""
    found: Exchanges = (1 - ANEW) * known + ANEW * usual * known.sum(axis=view, keepdims=True)
    return found


def _usual(aside: float, confused: float) -> Vector:
    """(2, 2) how often one view exchanges arms (rows) and legs (columns)."""
    part = PART + (PART_ASIDE - PART) * aside
    both = confused + (BOTH_ASIDE - confused) * aside
    return np.array([[1.0 - both - 2.0 * part, part], [part, both]])
