"""The background of a clip in which a person hides the same place throughout."""

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
"""Dilation of a body's mask: what lies beside the body has some of its colour, and is filled in
too."""
DARK, BRIGHT = np.float32(0), np.float32(255)


def learn_behind(
    frames: Sequence[Image], body: Mask, covered: Sequence[NDArray[np.uint8]]
) -> Background:
    """The background from pictures in which a person hides a known place most of the time.

    In that place it is what frames show that differs from the person and resembles what is
    interpolated from both sides, or is seen while the person is elsewhere. Where hardly a frame
    shows that, the background is unknown, and whatever is there is the body: the background is set
    as far from it as possible, since a guess might have the body's colour. When the person leaves,
    the landmarks show that what is left is a thing.

    Args:
        frames: Pictures from the whole clip, of one size.
        body: (H, W) the person in their median.
        covered: For each frame (H, W), 1 where a person may be.
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
