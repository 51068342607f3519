"""Pictures of several synthetic people of known places and sizes, for tests of who is in them."""

from itertools import islice
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats
from common.raster.similarity import Mask
from common.video.pictures import Image
from synth.picture.picture_examples import SIDE_PX, PictureExample, picture_examples

HIGH, WIDE = 240, 320


class Crowd(NamedTuple):
    """One picture and its ground truth, in the order in which the people were put there."""

    picture: Image
    masks: list[Mask]
    """(HIGH, WIDE) each: where that person is visible."""
    joints_px: list[Floats]
    """(15, 2) each, JOINT_NAMES order."""


def whole_people(seed: int, count: int) -> list[PictureExample]:
    """Pictures of people none of whom touches the border, of seeds from one on."""
    found: list[PictureExample] = []
    while len(found) < count:
        found += filter(_is_whole, islice(picture_examples(seed), 4))
        seed += 1
    return found[:count]


def crowd(people: list[PictureExample], places: list[tuple[int, int, int]], seed: int) -> Crowd:
    """People before a wall with some grain; later ones stand before earlier ones.

    Args:
        people: Whole ones.
        places: Of each: column of the middle, lowest row, height in pixels.
        seed: Of the wall.
    """
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(90, 150, (6, 8, 3)).astype(np.float32)
    picture = cv2.resize(coarse, (WIDE, HIGH)) + rng.normal(0.0, 4.0, (HIGH, WIDE, 3))
    masks: list[Mask] = []
    joints_px = []
    for example, (column, bottom, tall) in zip(people, places, strict=True):
        onto = _onto(example, column, bottom, tall)
        body = cv2.warpAffine(example.body.astype(np.float32), onto, (WIDE, HIGH))
        coverage = body[..., 3:] / 255.0
        picture = picture * (1.0 - coverage) + body[..., :3]
        mask = coverage[..., 0] > 0.5
        masks = [*(each & ~mask for each in masks), mask]
        joints_px.append(example.joints_px @ onto[:, :2].T + onto[:, 2])
    return Crowd(picture.clip(0, 255).astype(np.uint8), masks, joints_px)


def corners(mask: Mask) -> Floats:
    """(2, 2) top left and bottom right of a mask that is not empty."""
    rows, columns = np.nonzero(mask)
    return np.array([(columns.min(), rows.min()), (columns.max() + 1.0, rows.max() + 1.0)])


def _is_whole(example: PictureExample) -> bool:
    covered = example.body[..., 3] > 128
    border = np.concatenate([covered[0], covered[-1], covered[:, 0], covered[:, -1]])
    return bool(covered.any()) and not border.any()


def _onto(example: PictureExample, column: int, bottom: int, tall: int) -> NDArray[np.float64]:
    """(2, 3) from the example's pixels to the picture's."""
    low, high = corners(example.body[..., 3] > 128)
    scale = tall / (high - low)[1]
    assert scale < HIGH / SIDE_PX * 3
    middle = (low + high)[0] / 2
    return np.array([[scale, 0.0, column - scale * middle], [0.0, scale, bottom - scale * high[1]]])
