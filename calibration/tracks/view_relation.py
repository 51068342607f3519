"""The relation between two static cameras' pictures of one point at one instant."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

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
        weights = _weights(ours, theirs, shares)
        flat = weights.reshape(-1, LINEAR)
        forms = ((flat @ spread) * flat).sum(axis=1)
        m, n, k = np.unravel_index(np.argmin(forms), weights.shape[:3])
        one_deg, other_deg, share = ours[n], theirs[m], shares[k]
    least: Numbers = _weights(*(np.array([at]) for at in (one_deg, other_deg, share)))[0, 0, 0]
    return least


def _weights(one_deg: Numbers, other_deg: Numbers, share: Numbers) -> Numbers:
    """(m, n, k, 4) of n directions from down in view 1, m in view 2, and k of view 1's weights."""
    one, other, ours = np.radians(one_deg), np.radians(other_deg)[:, None], np.exp(share / 2.0)
    weights = np.empty((len(other_deg), len(one_deg), len(share), LINEAR))
    weights[..., 0], weights[..., 1] = (ours * turned(one)[:, None] for turned in (np.sin, np.cos))
    weights[..., 2], weights[..., 3] = (
        -1.0 / ours * turned(other)[..., None] for turned in (np.sin, np.cos)
    )
    return weights
