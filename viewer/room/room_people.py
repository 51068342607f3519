"""Who is in pictures of which nothing else is known: the network of landmarks is asked."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.observation import Landmarks
from common.video.pictures import Image
from viewer.landmarks.own_landmarks import found_anywhere, found_between
from viewer.room.body_region import Bytes, body_region

NOBODY: Final = 0.35
"""Probability that a picture is empty, below which it shows a person: 0.00 to 0.17 in pictures of a
person, 0.46 to 0.99 in empty ones (docs/measurements.md)."""
AROUND: Final = 0.07
"""Statures around the body that are not believed to be room: landmarks that nothing else holds are
off by so much, and shadows lie there."""

SURE: Final = 0.4
"""Looks that are less sure than this, in the median, do not show where the body ends: 0.43 to
0.88 in synthetic rooms that deceive (seeds from 1000 on), 0.04 to 0.37 in videos of which the
network makes nothing. That they are asked how sure they are was seen on these videos."""
SEVERAL: Final = 3
"""Fewer looks that see a person do not show where they stay."""
FEW: Final = 20
"""Per cent of looks that have them farther on each side are left out of that."""

MARGINS: Final = (0.2, 0.06)
"""How far a body may reach beyond its joints, in sides of what holds them, in the second look and
in the third."""


class Look(NamedTuple):
    """What the network makes of one picture."""

    landmarks: Landmarks
    """Anywhere, where no person is there."""
    is_somebody: bool

    def region(self, shape: tuple[int, ...], beyond: float) -> Bytes:
        """(H, W) 1 within so many statures of the body; 0 everywhere if there is none."""
        if not self.is_somebody:
            return np.zeros(shape[:2], np.uint8)
        return body_region(self.landmarks, shape, beyond)


def looked_at(pictures: Sequence[Image]) -> list[Look]:
    """Who is in each of the pictures, (H, W, 3) each.

    A look at all of a picture is coarse. Who is seen in several stays about where the surest looks
    have them: there all are looked at again, widely, as feet are easily left out, then closely;
    a person may be seen there who was too small in all of the picture. Where that is not sure
    either they may all be led astray together, and the first looks count.
    """
    found = (found_anywhere(picture) for picture in pictures)
    first = looks = [Look(landmarks, nobody < NOBODY) for landmarks, nobody in found]
    if sum(look.is_somebody for look in looks) < SEVERAL:
        return looks
    for margin in MARGINS:
        corners_px = _place([look.landmarks for look in looks if look.is_somebody])
        found = (found_between(picture, corners_px, margin) for picture in pictures)
        looks = [
            Look(landmarks, is_somebody=True) if look.is_somebody or nobody < NOBODY else look
            for look, (landmarks, nobody) in zip(looks, found, strict=True)
        ]
    return looks if are_sure(looks) else first


def are_sure(looks: Sequence[Look]) -> bool:
    """Whether what looks have of a person is sure enough to separate body and background."""
    sure = [np.mean(look.landmarks.confidence) for look in looks if look.is_somebody]
    return bool(sure) and float(np.median(sure)) >= SURE


def _place(shown: Sequence[Landmarks]) -> NDArray[np.float64]:
    """The corners, (2, 2), between which most of the surer half have all joints."""
    sure = np.array([np.mean(each.confidence) for each in shown])
    joints_px = np.array([each.joints_px for each in shown])[sure >= np.median(sure)]
    low, high = joints_px.min(axis=1), joints_px.max(axis=1)
    corners = np.percentile(low, FEW, axis=0), np.percentile(high, 100 - FEW, axis=0)
    return np.stack(corners)
