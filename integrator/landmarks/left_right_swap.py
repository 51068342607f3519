"""Whether a view exchanged left and right: of the arms, of the legs, or of both."""

from typing import Any, Final, NamedTuple

import numpy as np

from common.body.body import Vector

PART: Final = 0.005
"""Prior probability that a view exchanges the arms alone, or the legs alone, of a person whom it
sees from the front or the back."""
PART_ASIDE: Final = 0.08
"""The same of a person seen in profile, where the limbs of both sides overlap: of synthetic
people's profiles 3 to 9 % have the arms exchanged, 9 to 14 % the legs."""
BOTH_ASIDE: Final = 0.05
"""Prior probability that both are exchanged in a profile; in a front view it is the probability
that front was taken for back."""
ANEW: Final = 0.33
"""Probability that a view's exchange is drawn anew from the prior at the next instant."""
TRUST: Final = 0.67
"""Exponent of an instant's likelihood: the errors of its joints are correlated."""

JOINTLY: Final = 3
"""Number of views up to which all exchanges are weighed jointly; with more, each view
separately."""

Exchanges = Vector
"""Posterior of the exchanges: (2,) * 2V for up to JOINTLY views, all views' arms before all views'
legs; (V, 2, 2) for more, by view, arms, legs."""


class Exchanged(NamedTuple):
    """Which views exchanged left and right."""

    arms: tuple[int, ...]
    """One number per view; 1: exchanged."""
    legs: tuple[int, ...]


def step(
    before: Exchanges | None,
    arms: Vector,
    legs: Vector,
    aside: tuple[float, ...],
    confused: tuple[float, ...],
    faced: Vector | float = 0.0,
) -> tuple[Exchanges, Exchanged]:
    """One instant of a hidden Markov model whose 4^V states are all possible exchanges.

    Args:
        before: Posterior of the instant before; None at the first.
        arms: (2,) * V log likelihood of the arms' joints, by the views that exchanged them.
        legs: (2,) * V log likelihood of the legs' joints.
        aside: How much each view sees a profile: 0 front or back, 1 profile.
        confused: Probability that each view took front for back.
        faced: (2,) * 2V log likelihood of the views' facings, by the arms and the legs exchanged.
    """
    views = len(aside)
    expected: Any = 1.0 if before is None else before
    for view, each in enumerate(zip(aside, confused, strict=True)):
        own = (view, views + view)
        usual = _usual(*each).reshape([2 if axis in own else 1 for axis in range(2 * views)])
        expected = expected * usual if before is None else _drawn_anew(expected, usual, own)
    said = arms.reshape(arms.shape + (1,) * views) + legs + faced
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
    """One instant of such a model for each view separately.

    Args:
        before: As for `step`, (V, 2, 2).
        arms: (V, 2) log probability of all the arms' joints, exchanged or not by one view, the
            others as they were.
        legs: (V, 2) the same for the legs.
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
    """The prediction for the next instant, in which one view's axes may be drawn anew."""
    found: Exchanges = (1 - ANEW) * known + ANEW * usual * known.sum(axis=view, keepdims=True)
    return found


def _usual(aside: float, confused: float) -> Vector:
    """(2, 2) prior of one view: arms exchanged (rows), legs exchanged (columns)."""
    part = PART + (PART_ASIDE - PART) * aside
    both = confused + (BOTH_ASIDE - confused) * aside
    return np.array([[1.0 - both - 2.0 * part, part], [part, both]])
