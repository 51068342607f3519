"""The relation between two static cameras' pictures of one point at one instant."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

LINEAR: Final = 4
"""Indices of the terms that far cameras need: x and y in either view."""
NEARLY_FAR: Final = 1e-4
"""Penalty of the other terms, which tell near from far: without it they explain anything."""
TRIED: Final = np.stack(
    np.meshgrid(*2 * [np.arange(-45.0, 46.0, 7.5)], np.arange(-0.3, 0.31, 0.1)), axis=-1
).reshape(-1, 3)
"""Ranges of the search: directions in either picture from down, degrees, and the logarithm of
view 1's weight over view 2's."""
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
    at = np.zeros(3)
    for finer in FINER:
        tried = at + finer * TRIED
        weights = _weights(tried)
        at = tried[np.argmin(((weights @ spread) * weights).sum(axis=1))]
    least: Numbers = _weights(at[None])[0]
    return least


def _weights(tried: Numbers) -> Numbers:
    """(n, 4) directions, from down in either picture, and view 1's weight."""
    turns, share = np.radians(tried[:, :2]), np.exp(tried[:, 2] / 2.0)
    across, down = np.sin(turns), np.cos(turns)
    ours, theirs = share[:, None], -1.0 / share[:, None]
    one, other = (np.stack([across[:, n], down[:, n]], axis=1) for n in (0, 1))
    return np.hstack([ours * one, theirs * other])
