"""Who is in pictures of which nothing else is known: the network of landmarks is asked."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from common.bus.messages import Landmarks
from common.video.decoding import Image
from viewer.landmarks.body_region import Bytes, body_region
from viewer.landmarks.own_landmarks import found_anywhere

NOBODY: Final = 0.35
"""Where it is less likely than this that nobody is there, somebody is: 0.00 to 0.17 with somebody,
0.46 to 0.99 in empty rooms of r01, r04 and made-up people."""
AROUND: Final = 0.07
"""Statures around the body that are not believed to be room: landmarks that nothing else holds are
off by so much, and shadows lie there."""


class Look(NamedTuple):
    """What the network makes of one picture."""

    landmarks: Landmarks
    """Anywhere, where nobody is there."""
    is_somebody: bool

    def region(self, shape: tuple[int, ...], beyond: float) -> Bytes:
        """(H, W) 1 within so many statures of the body; 0 everywhere if there is none."""
        if not self.is_somebody:
            return np.zeros(shape[:2], np.uint8)
        return body_region(self.landmarks, shape, beyond)


def looked_at(pictures: Sequence[Image]) -> list[Look]:
    """Who is in each of the pictures, (H, W, 3) each, whatever the others show."""
    found = (found_anywhere(picture) for picture in pictures)
    return [Look(landmarks, nobody < NOBODY) for landmarks, nobody in found]
