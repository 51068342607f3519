"""Whose landmarks a report tells: those of the person whose outline it tells."""

import numpy as np

from common.bus.messages import Box, Landmarks


def nearest_landmarks(people: tuple[Landmarks, ...], box: Box | None) -> Landmarks | None:
    """Who fills the box of the outline best; where there is none, who is largest.

    Args:
        people: Whom a source outside sees in a picture.
        box: Of the outline in it.
    """
    if not people:
        return None
    extents = np.array([_extent(one) for one in people])
    if box is None:
        sides = extents[:, 2:] - extents[:, :2]
        return people[int(sides.prod(axis=1).argmax())]
    outline = np.array([box.left, box.top, box.right + 1, box.bottom + 1], np.float64)
    return people[int(np.abs(extents - outline).sum(axis=1).argmin())]


def _extent(one: Landmarks) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of the joints that are seen; of all where none is."""
    places = np.array(one.joints_px)
    known = np.array(one.confidence) > 0
    places = places[known] if known.any() else places
    return (*places.min(axis=0).tolist(), *places.max(axis=0).tolist())
