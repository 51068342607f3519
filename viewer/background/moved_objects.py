"""Objects that appear or disappear during a clip: doors, chairs, captions (after T7)."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from common.raster.similarity import Mask
from common.video.pictures import Image
from viewer.background.background import Background, even_light, spread_of
from viewer.background.image_stack import CHANGES, LUMA, Floats, median, squares

AT_REST_S: Final = 10.0
"""Seconds after which a constant region is an object: no standing person holds still for so
long, edges included. A person who lies still for longer is lost until they move."""
FEWEST: Final = 6
"""Fewest pictures within that time that reveal a moved object."""
CALM: Final = 0.9
"""Share of those pictures in which a pixel of an object must be the same: a person may pass in
front."""
RESTLESS: Final = 0.35
"""Share of an object's surroundings that may move; around a bending trunk more does."""
LOOKS: Final = 6
"""Number of pictures within that time that are compared with the background."""
SPECKS_PX: Final = 5
EDGE_PX: Final = 2
"""Width of an object's edge beyond what differs clearly from the background, pixels."""


class Patch(NamedTuple):
    """A change of the background from a frame on."""

    frame: int
    where: Mask
    """(H, W)."""
    centre: Floats
    """(n, 3) grey levels of these pixels."""
    spread: Floats
    """(n, 2) standard deviations of brightness and of colour of these pixels, grey levels."""


def patches_of(
    background: Background, frames: Sequence[Image], spacing: int, fps: float
) -> list[Patch]:
    """Objects that come to rest in a clip, or leave their place, in the order of time.

    Where the background was guessed, the first object at rest was there from the start.

    Args:
        background: Learnt from the whole clip.
        frames: Pictures (H, W, 3) from the whole clip, from its first on.
        spacing: Frames of the clip between two of them.
        fps: Frame rate of the clip.
    """
    due = max(FEWEST, math.ceil(AT_REST_S * fps / spacing))
    found: list[Patch] = []
    if len(frames) < due:
        return found
    guessed = background.uncertain.copy()
    even, now = (
        even_light([*frames, np.asarray(np.rint(background.centre), np.uint8)])[:-1],
        background.centre,
    )
    for start in range(0, len(frames) - due + 1, max(1, due // LOOKS)):
        window = even[start : start + due]
        shown = median(window)
        off = window - shown
        settled = _smooth((np.abs(off @ LUMA) < CHANGES).mean(axis=0) >= CALM)
        other = _moved_objects(shown, now, settled)
        now = np.where(other[..., None], shown, now)
        spread = spread_of(squares(off), due)
        for where, frame in ((other & guessed, 0), (other & ~guessed, start * spacing)):
            if where.any():
                found.append(Patch(frame, where, shown[where], spread[where]))
        guessed &= ~other
    return sorted(found, key=lambda patch: patch.frame)


def _smooth(mask: Mask) -> Mask:
    """Without the specks that compression leaves along edges."""
    return np.asarray(cv2.medianBlur(mask.view(np.uint8), SPECKS_PX) > 0)


def _moved_objects(shown: Floats, now: Floats, settled: Mask) -> Mask:
    """(H, W) True where something at rest differs from the original background.

    A region that differs, with everything that moves and touches it, is an object if little of the
    ring around it moves.
    """
    differs = settled & (np.abs((shown - now) @ LUMA) > CHANGES)
    beyond = np.ones((3, 3), np.uint8)
    count, labels = cv2.connectedComponents(differs.view(np.uint8))
    ring = cv2.dilate(labels.astype(np.float32), beyond).astype(np.int32) * ~differs
    around = np.bincount(ring.ravel(), minlength=count)
    moving = np.bincount(ring[~settled], minlength=count) / np.maximum(around, 1)
    thing = differs & (moving[labels] < RESTLESS)
    reach = np.ones((2 * EDGE_PX + 1,) * 2, np.uint8)
    return settled & (cv2.dilate(thing.view(np.uint8), reach) > 0)
