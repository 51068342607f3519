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


@compiled
def relation_of(terms: Numbers, weights: Numbers) -> Relation:
    """The relation that points (n, 8) miss least, weighted (n,).

    Far cameras see a point equally high along a direction of each picture, in one unit of length.
    If the views' weights were free, a person who shows a line in one view would explain anything in
    the other; perspective changes heights a little.
    """
    means, spread = _moments(terms, weights)
    for term in range(len(means) - 1, LINEAR - 1, -1):  # each follows those before it
        spread[term, term] += NEARLY_FAR
        for i in range(term):
            for j in range(term):
                spread[i, j] -= spread[i, term] * spread[term, j] / spread[term, term]
    found = np.zeros(len(means))
    found[:LINEAR] = _least(spread)
    for term in range(LINEAR, len(means)):
        found[term] = -(spread[term] * found)[:term].sum() / spread[term, term]
    return Relation(found, means)


@compiled
def _moments(terms: Numbers, weights: Numbers) -> tuple[Numbers, Numbers]:
    """(8,) means of terms (n, 8), and (8, 8) their spread."""
    count, shares = terms.shape[1], weights / weights.sum()
    means, spread = np.zeros(count), np.zeros((count, count))
    for i in range(count):
        for n in range(len(terms)):
            means[i] += shares[n] * terms[n, i]
    for n in range(len(terms)):
        for i in range(count):
            around = shares[n] * (terms[n, i] - means[i])
            for j in range(count):
                spread[i, j] += around * (terms[n, j] - means[j])
    return means, spread


@compiled
def _least(spread: Numbers) -> Numbers:
    """(4,) weights of both views for which the quadratic form of the first terms is least."""
    one_deg, other_deg, share = 0.0, 0.0, 0.0
    for finer in FINER:
        ours, theirs = one_deg + finer * TURNS_DEG, other_deg + finer * TURNS_DEG
        shares = share + finer * SHARES
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


@compiled
def _weights(one_deg: float, other_deg: float, share: float) -> Numbers:
    """(4,) weights of a direction from down in either view, and a share."""
    one, other = np.radians(one_deg), np.radians(other_deg)
    ours = np.exp(share / 2.0)
    theirs = -1.0 / ours
    return np.array(
        [ours * np.sin(one), ours * np.cos(one), theirs * np.sin(other), theirs * np.cos(other)]
    )
