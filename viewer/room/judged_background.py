"""Which of several backgrounds explains what the landmarks show: none of them is taken on trust."""

from collections.abc import Callable, Iterable, Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from common.config.part_settings import SilhouetteSettings
from common.method import DEFAULT
from common.raster.similarity import Mask
from common.video.pictures import Image
from viewer.background.background import Background
from viewer.room.body_region import body_region
from viewer.room.room_people import Look
from viewer.silhouette import silhouette

Maker = Callable[[], Background]

GOOD: Final = 0.6
"""A silhouette that has as much of the body, and hardly anything else, needs no other to be
tried."""
BESIDE: Final = 0.08
"""Statures around the body in which a silhouette may lie: clothes, hair, landmarks a bit off."""
SURELY: Final = 0.05
"""By so much one that is less likely must fit better: in synthetic rooms that was the better
one."""
FAR: Final = 0.2
"""Statures from the body at which a silhouette is another person's, or an object's."""
JUDGED: Final = 5
"""Frames, spread over those that were looked at."""


class Judged(NamedTuple):
    """A background, and how well the silhouettes in it fit the landmarks."""

    background: Background
    worth: float
    """In [0, 1]."""


def best_of(
    groups: Sequence[Sequence[Maker]],
    pictures: Sequence[Image],
    looks: Sequence[Look],
    settings: SilhouetteSettings,
) -> Background:
    """The background whose silhouettes fit the landmarks best; the first group that is good is
    taken.

    Args:
        groups: Make the backgrounds, the likeliest first; of a group all are made, and the best
            stands for it.
        pictures: Of the clip, (H, W, 3) each.
        looks: What the network makes of each.
        settings: How a person is distinguished from the background.
    """
    shown = [pair for pair in zip(pictures, looks, strict=True) if pair[1].is_somebody]
    told = shown[:: max(1, -(-len(shown) // JUDGED))]
    if not told:
        return groups[0][0]()

    def judged(make: Maker) -> Judged:
        background = make()
        return Judged(background, _worth(background, told, settings))

    return _first((_first(map(judged, makers), 1.0) for makers in groups), GOOD).background


def _first(tried: Iterable[Judged], good: float) -> Judged:
    """The first that is so good, else the best; no more are made than that takes."""
    found: Judged | None = None
    for now in tried:
        found = now if found is None or now.worth > found.worth + SURELY else found
        if found.worth >= good:
            break
    assert found is not None
    return found


def _worth(
    background: Background, told: Sequence[tuple[Image, Look]], settings: SilhouetteSettings
) -> float:
    """How well silhouettes in a background fit the landmarks, in [0, 1], the mean over frames."""
    state = silhouette.init(background, settings, DEFAULT)
    worth = []
    for picture, look in told:
        middle = np.mean(look.landmarks.joints_px, axis=0)
        near_px = (float(middle[0]), float(middle[1]))
        worth.append(fit(silhouette.step(state, picture, near_px)[1].mask, look))
    return float(np.mean(worth))


def fit(mask: Mask, look: Look) -> float:
    """Share of the body that a silhouette (H, W) covers, times the share of it that is body's.

    What is far from the body does not count: that is separated from it in every frame.
    """
    outline = cv2.bitwise_and(mask.view(np.uint8), body_region(look.landmarks, mask.shape, FAR))
    body = body_region(look.landmarks, mask.shape, 0.0)
    near = body_region(look.landmarks, mask.shape, BESIDE)
    covered = cv2.countNonZero(cv2.bitwise_and(outline, body)) / max(1, cv2.countNonZero(body))
    own = cv2.countNonZero(cv2.bitwise_and(outline, near)) / max(1, cv2.countNonZero(outline))
    return covered * own
