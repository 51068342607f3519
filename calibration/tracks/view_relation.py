"""The one relation that any two cameras which stand impose on what both see at one instant."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

LINEAR: Final = 4
"""Of the terms, those that far cameras need: x and y in either view."""
NEARLY_FAR: Final = 1e-4
"""How dear the other terms are, which distinguish near from far: without a price they explain
anything."""
TRIED: Final = np.stack(
    np.meshgrid(*2 * [np.arange(-45.0, 46.0, 7.5)], np.arange(-0.3, 0.31, 0.1)), axis=-1
).reshape(-1, 3)
"""Of directions in either picture from down, degrees, and of how much more view 1 counts than view
2 (of its logarithm)."""
FINER: Final = (1.0, 1.0 / 6.0, 1.0 / 36.0)
"""Steps of the searches around the best, one after the other, in those of the first search."""


class Relation(NamedTuple):
    """What is 0 of a point that both views show."""

    weights: Numbers
    """(8,) of the terms, less their `means`."""
    means: Numbers
    """(8,)"""

    def off(self, terms: Numbers) -> Numbers:
        """(...) by how much points miss it, in the units of their places."""
        off: Numbers = (terms - self.means) @ self.weights
        return off


def terms_of(one: Numbers, other: Numbers) -> Numbers:
    """(..., 8) of points (..., 2) in both views, about the middle of what each shows.

    What two views show of a point is bound by a bilinear equation, whatever the cameras are: the
    fundamental matrix's, each of whose terms but the constant is one of these.
    Source: Hartley and Zisserman 2004, section 9.2.
    """
    products = one[..., :, None] * other[..., None, :]
    flat = products.reshape(*products.shape[:-2], LINEAR)
    return np.concatenate([one, other, flat], axis=-1)


def relation_of(terms: Numbers, weights: Numbers) -> Relation:
    """The relation that points (n, 8) miss least, weighed (n,).

    Far cameras see a point equally high along a direction of each picture, where places are in
    one unit. Were the views' shares free, a person who shows a line in one of them would explain
    anything in the other; a little more or less is what near and far make of heights.
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
    """(n, 4) of directions, from down in either picture, and by how much view 1 counts more."""
    turns, share = np.radians(tried[:, :2]), np.exp(tried[:, 2] / 2.0)
    across, down = np.sin(turns), np.cos(turns)
    ours, theirs = share[:, None], -1.0 / share[:, None]
    one, other = (np.stack([across[:, n], down[:, n]], axis=1) for n in (0, 1))
    return np.hstack([ours * one, theirs * other])
