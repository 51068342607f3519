"""The background of a clip in which a person hides the same place all through."""

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.raster.similarity import Mask
from common.video.pictures import Image
from viewer.background.background import Background, even_light
from viewer.background.image_stack import CHANGES, LUMA, Floats, median
from viewer.background.occluded_background import SHOWN, bridged, estimated_of

BESIDE: Final = np.ones((3, 3), np.uint8)
"""What lies beside a body has some of its colour: it is drawn from both sides too."""
DARK, BRIGHT = np.float32(0), np.float32(255)


def learn_behind(
    frames: Sequence[Image], body: Mask, covered: Sequence[NDArray[np.uint8]]
) -> Background:
    """The background from pictures of which it is known where a person hides it in most.

    It is what frames show there that is not what hides it, and comes near what is drawn from both
    sides, or is seen while they are elsewhere. Where hardly a frame shows that, nothing is known of
    it; but whatever is there is the body: so the background is taken to be as far from that as it
    can be, since a guess may as well be the body's colour. When they leave, the landmarks show what
    is left there to be a thing.

    Args:
        frames: Pictures from all over a clip, of one size.
        body: (H, W) of whoever their median shows.
        covered: Of each frame (H, W), 1 where a person may be.
    """
    even = even_light(frames)
    centre = median(even)
    away = np.abs(even - centre).max(axis=3)
    held = cv2.dilate(body.view(np.uint8), BESIDE) > 0
    background = bridged(centre, held)
    near = np.abs((even - background) @ LUMA) < CHANGES
    shows = held & (near | (np.stack(covered) == 0)) & ((away > CHANGES) | ~body)
    count = shows.sum(axis=0)
    unseen = held & (count < SHOWN * len(even))
    seen = held & ~unseen
    background[seen] = _mean(even, shows, count)[seen]
    hidden = unseen & body
    background[hidden] = np.where(centre[hidden] > (DARK + BRIGHT) / 2, DARK, BRIGHT)
    return estimated_of(even - centre, away, background, held, unseen)


def _mean(even: Floats, shows: Mask, count: np.ndarray) -> Floats:
    """(H, W, 3) the mean of the frames that show a pixel; 0 where none does."""
    total = (even * shows[..., None]).sum(axis=0)
    found: Floats = total / np.maximum(count, 1)[..., None]
    return found
