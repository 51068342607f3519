"""The relation between two static cameras' pictures of one point at one instant."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.compiled import compiled

Numbers = NDArray[np.float64]

LINEAR: Final = 4
"""Indices of the terms that far cameras need: x and y in either view."""
NEARLY_FAR: Final = 1e-4
"""Penalty of the other terms, which tell near from far: without it they explain anything."""
TURNS_DEG: Final = np.arange(-45.0, 46.0, 7.5)
"""Range of the search: directions in either picture, from down."""
SHARES: Final = np.arange(-0.3, 0.31, 0.1)
"""Range of the search: the logarithm of view 1's weight over view 2's."""
FINER: Final = (1.0, 1.0 / 6.0, 1.0 / 36.0)
"""Steps of the successive searches around the best, in steps of the first."""


class Relation(NamedTuple):
    """A linear form that is 0 at every point that both views show."""

    weights: Numbers
    """(8,) coefficients of the terms, less their `means`."""
    means: Numbers
    """(8,)"""

    def off(self, terms: Numbers) -> Numbers:
        """(...) misses of points, in the units of their places."""
        off: Numbers = (terms - self.means) @ self.weights
        return off


def terms_of(one: Numbers, other: Numbers) -> Numbers:
    """(..., 8) terms of points (..., 2) in both views, about the middle of each.

    Two views of a point satisfy a bilinear equation, whatever the cameras are: the fundamental
    matrix's, whose terms, the constant aside, are these. Source: Hartley and Zisserman 2004,
    section 9.2.
    """
    products = one[..., :, None] * other[..., None, :]
    flat = products.reshape(*products.shape[:-2], LINEAR)
    return np.concatenate([one, other, flat], axis=-1)


def relation_of(terms: Numbers, weights: Numbers) -> Relation:
    """The relation that points (n, 8) miss least, weighted (n,).

    Far cameras see a point equally high along a direction of each picture, in one unit of length.
    If the views' weights were free, a person who shows a line in one view would explain anything in
    the other; perspective changes heights a little.
    """
    share = weights / weights.sum()
    means = share @ terms
    around = terms - means
    spread = (around * share[:, None]).T @ around
    mixed, near = spread[LINEAR:, :LINEAR], spread[LINEAR:, LINEAR:]
    follow = -np.linalg.solve(near + NEARLY_FAR * np.eye(len(near)), mixed)
    far = _least(spread[:LINEAR, :LINEAR] + mixed.T @ follow)
    return Relation(np.concatenate([far, follow @ far]), means)


def _least(spread: Numbers) -> Numbers:
    """(4,) weights of both views for which the quadratic form (4, 4) is least."""
    one_deg, other_deg, share = 0.0, 0.0, 0.0
    for finer in FINER:
        ours, theirs, shares = (
            at + finer * tried
            for at, tried in ((one_deg, TURNS_DEG), (other_deg, TURNS_DEG), (share, SHARES))
        )
        m, n, k = _least_of(spread, np.radians(ours), np.radians(theirs), np.exp(shares))
        one_deg, other_deg, share = ours[n], theirs[m], shares[k]
    return _weights(one_deg, other_deg, share)


@compiled
def _least_of(
    spread: Numbers, one: Numbers, other: Numbers, shares: Numbers
) -> tuple[int, int, int]:
    """Which of m directions in view 2, n in view 1 and k shares give the least of the quadratic
    form (4, 4) at their `_weights`: a share weighs what is of one view alone, not what is mixed."""
    least, best = np.inf, (0, 0, 0)
    for m in range(len(other)):
        there = np.array([-np.sin(other[m]), -np.cos(other[m])])
        for n in range(len(one)):
            here = np.array([np.sin(one[n]), np.cos(one[n])])
            ours, theirs, mixed = 0.0, 0.0, 0.0
            for i in range(2):
                for j in range(2):
                    ours += here[i] * spread[i, j] * here[j]
                    theirs += there[i] * spread[i + 2, j + 2] * there[j]
                    mixed += here[i] * (spread[i, j + 2] + spread[j + 2, i]) * there[j]
            for k in range(len(shares)):
                form = ours * shares[k] + theirs / shares[k] + mixed
                if form < least:
                    least, best = form, (m, n, k)
    return best


def _weights(one_deg: float, other_deg: float, share: float) -> Numbers:
    """(4,) weights of a direction from down in either view, and a share."""
    one, other = np.radians([one_deg, other_deg])
    ours = np.exp(share / 2.0)
    theirs = -1.0 / ours
    return np.array(
        [ours * np.sin(one), ours * np.cos(one), theirs * np.sin(other), theirs * np.cos(other)]
    )
