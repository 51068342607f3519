"""The hard shadow that feet cast along the floor, cut from a standing silhouette."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.raster.similarity import Mask
from viewer.background.image_stack import LUMA, Floats, Frame

FLOOR_SHARE: Final = 0.22
"""So much of a standing person's height is near the floor; a shadow from the side lies there."""
SHINS_SHARE: Final = 0.12
"""Above that so much shows where the legs come down."""
FOOT_SHARE: Final = 0.06
"""How far a heel or toe may be from the columns of the shins without being asked for its colour."""
SHADOW: Final = (0.4, 0.95)
"""Share of the floor's light that a hard shadow leaves; shoes and trousers leave less, or more."""
GREY: Final = 8.0
"""Grey levels by which a shadow's colour may differ from that of the floor, made as dark."""


def without_cast(mask: Mask, picture: Frame, room: Floats) -> Mask:
    """The silhouette of somebody who stands, without the shadow beside the feet.

    Args:
        mask: (H, W), not empty.
        picture: (H, W, 3) under the room's light.
        room: (H, W, 3), empty.
    """
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    box = slice(top, top + height), slice(left, left + width)
    found = mask.copy()
    found[box] = _without_cast(mask[box], picture[box], room[box])
    return found


def _without_cast(mask: Mask, picture: Frame, room: Floats) -> Mask:
    """The same in the silhouette's own box."""
    tall = len(mask)
    floor = tall - max(1, round(FLOOR_SHARE * tall))
    shins = mask[floor - max(1, round(SHINS_SHARE * tall)) : floor].any(axis=0)
    reach = max(1, round(FOOT_SHARE * tall))
    columns = np.flatnonzero(shins)
    beside = np.abs(np.arange(mask.shape[1])[:, None] - columns).min(axis=1, initial=10**6) > reach
    found = mask.copy()
    found[floor:] &= ~(beside & _shaded(picture[floor:], room[floor:]))
    return _without_scraps(found, floor, beside) if found[floor:].any() else mask


def _without_scraps(mask: Mask, floor: int, beside: Mask) -> Mask:
    """The silhouette without regions that lie on the floor alone, beside the feet."""
    count, labels = cv2.connectedComponents(mask.view(np.uint8))
    elsewhere = np.zeros(count, np.bool_)
    elsewhere[labels[:floor]] = True
    elsewhere[labels[:, ~beside]] = True
    elsewhere[0] = False
    return np.asarray(elsewhere[labels])


def _shaded(picture: NDArray[np.uint8], room: Floats) -> Mask:
    """(H, W) True where the picture is the room, only darker."""
    share = (picture @ LUMA) / np.maximum(room @ LUMA, 1.0)
    off = np.abs(picture - share[..., None] * room).max(axis=2)
    return np.asarray((share > SHADOW[0]) & (share < SHADOW[1]) & (off < GREY))
