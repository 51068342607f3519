"""Colours of people's clothes: how much two differ, and who wears another's."""

from collections.abc import Sequence
from typing import Final

import numpy as np

COLOUR_SCALE: Final = 40.0
"""Unit of a difference of colours, in units of L*a*b*."""
ALIKE: Final = 0.1
"""Difference of colours below which clothes do not distinguish people."""
TAKEN: Final = 0.4
"""By how much nearer colours are to another's clothes than to their own, in what these differ,
where people were taken for each other."""

Colours = Sequence[float]
"""Mean L*a*b* of the upper, then of the lower part, (6,); empty: not known."""


def colour_distance(one: Colours, other: Colours) -> float:
    """Difference of two people's colours; 0 where one is not known."""
    if not one or not other:
        return 0.0
    off = np.subtract(one, other).reshape(-1, 3)
    return float(np.linalg.norm(off, axis=1).mean()) / COLOUR_SCALE


def exchange_gain(mine: Colours, theirs: Colours, first: Colours, second: Colours) -> float:
    """By how much nearer the colours of two observations are to the other person's than to their
    own, in what these differ: 1 of two who were taken for each other, -1 else; 0 where they are
    alike, or not known.

    Args:
        mine: The clothes of the person who is taken to be in the first observation.
        theirs: Those of the other person.
        first: Colours of the first observation; empty: there is none.
        second: Of the second.
    """
    between = colour_distance(mine, theirs)
    pairs = [(first, mine, theirs), (second, theirs, mine)]
    gains = [
        colour_distance(own, seen) - colour_distance(others, seen)
        for seen, own, others in pairs
        if seen
    ]
    return float(np.mean(gains)) / between if gains and between >= ALIKE else 0.0
