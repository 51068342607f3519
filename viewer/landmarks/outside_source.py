"""Sources of landmarks outside of the viewer's step, a process or files, and whose they are."""

from typing import Protocol

import numpy as np

from common.body.observation import Box, Landmarks
from common.video.pictures import Decoded, Size


class OutsideSource(Protocol):
    """Sees one view's frames in their order; asked by the shells, never by a step."""

    @property
    def large(self) -> Size | None:
        """Size of the picture that it looks at; None: the working picture, or none."""

    @property
    def odd(self) -> tuple[str, ...]:
        """What went wrong so far, a line each."""

    def people(self, decoded: Decoded, wait_s: float) -> tuple[Landmarks, ...]:
        """The landmarks of every person in a frame, in pixels of the working picture.

        Args:
            decoded: The frame, with a picture of the size `large`, if that is one.
            wait_s: How long to wait for the answer; no person is there when it does not come.
        """


def nearest_landmarks(people: tuple[Landmarks, ...], box: Box | None) -> Landmarks | None:
    """The person of a report: the one who fills the silhouette's box best; without a silhouette the
    largest.

    Args:
        people: Whom a source outside sees in a picture.
        box: Of the silhouette in it.
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
