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

JOINTLY: Final = 3
"""Views of which all exchanges are weighed together; of more, those of each by themselves."""

Exchanges = Vector
"""How probably arms are exchanged by each view, and legs likewise: (2,) * 2V, all views' arms
before all views' legs, of up to JOINTLY views; (V, 2, 2) of more."""


class Exchanged(NamedTuple):
    """Which views took left for right."""

    arms: tuple[int, ...]
    """By each view; 1: it did."""
    legs: tuple[int, ...]


def step(
    before: Exchanges | None,
    arms: Vector,
    legs: Vector,
    aside: tuple[float, ...],
    confused: tuple[float, ...],
) -> tuple[Exchanges, Exchanged]:
    """One instant of a hidden Markov model whose 4^V states are all that may be exchanged.

    Args:
        before: At the instant before; None at the first.
        arms: (2,) * V log probability of all the arms' joints, exchanged by each view.
        legs: (2,) * V of the legs'.
        aside: Of each view, from 0 (it sees front or back) to 1 (a profile).
        confused: Of each view, how probably it took front for back.
    """
    views = len(aside)
    expected: Any = 1.0 if before is None else before
    for view, each in enumerate(zip(aside, confused, strict=True)):
        own = (view, views + view)
        usual = _usual(*each).reshape([2 if axis in own else 1 for axis in range(2 * views)])
        expected = expected * usual if before is None else _drawn_anew(expected, usual, own)
    said = arms.reshape(arms.shape + (1,) * views) + legs
    now = expected * np.exp(TRUST * (said - said.max()))
    now /= now.sum()
    best = tuple(int(i) for i in np.unravel_index(now.argmax(), now.shape))
    return now, Exchanged(best[:views], best[views:])


def step_each(
    before: Exchanges | None,
    arms: Vector,
    legs: Vector,
    aside: tuple[float, ...],
    confused: tuple[float, ...],
) -> tuple[Exchanges, Exchanged]:
    """One instant of such a model of each view by itself.

    Args:
        before: As for `step`, (V, 2, 2).
        arms: (V, 2) log probability of all the arms' joints, exchanged or not by one view, the
            others as they were.
        legs: (V, 2) of the legs'.
        aside: As for `step`.
        confused: As for `step`.
    """
    known = [None] * len(aside) if before is None else list(before)
    views = zip(known, arms, legs, _each(aside), _each(confused), strict=True)
    found = [step(*own) for own in views]
    return np.stack([now for now, _ in found]), Exchanged(
        tuple(decided.arms[0] for _, decided in found),
        tuple(decided.legs[0] for _, decided in found),
    )


def _each(views: tuple[float, ...]) -> list[tuple[float, ...]]:
    return [(own,) for own in views]


def _drawn_anew(known: Exchanges, usual: Vector, view: tuple[int, int]) -> Exchanges:
    """What is expected next where now and then the axes of one view are drawn from the usual."""
    found: Exchanges = (1 - ANEW) * known + ANEW * usual * known.sum(axis=view, keepdims=True)
    return found


def _usual(aside: float, confused: float) -> Vector:
    """(2, 2) how often one view exchanges arms (rows) and legs (columns)."""
    part = PART + (PART_ASIDE - PART) * aside
    both = confused + (BOTH_ASIDE - confused) * aside
    return np.array([[1.0 - both - 2.0 * part, part], [part, both]])
