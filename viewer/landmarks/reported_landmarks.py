"""Whose landmarks a report tells: those of the person whose outline it tells."""

import numpy as np

from common.bus.messages import Box, Landmarks
from common.video.decoding import Image
from viewer.landmarks.own_landmarks import own_landmarks
from viewer.silhouette.silhouette import Seen


def reported_landmarks(
    source: str, picture: Image, people: tuple[Landmarks, ...], seen: Seen
) -> Landmarks | None:
    """The landmarks of the person who is followed; None where nobody's are known.

    Args:
        source: `Settings.landmarks`.
        picture: (H, W, 3) the working picture.
        people: Whom a source outside sees in it.
        seen: The outline in it.
    """
    if source == "own":
        return own_landmarks(picture, seen)
    return _nearest(people, seen.box)


def _nearest(people: tuple[Landmarks, ...], box: Box | None) -> Landmarks | None:
    """Who fills the box of the outline best; where there is none, who is largest."""
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
