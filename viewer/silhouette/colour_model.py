"""Which colours the body wears and which the background around it has, learnt while one looks."""

from typing import Final

import numpy as np

from common.compiled import KERNEL
from common.video.pictures import Image
from viewer.background.background import BackgroundModel
from viewer.background.image_stack import Bytes, Floats
from viewer.silhouette.difference import light_of, shade_of, unshaded

SHADES: Final = 2048
"""8 steps of brightness times 16 x 16 of blue and red against it."""
KEPT: Final = np.float32(0.95)
"""Share of the counts that a frame leaves to the next: 20 frames are remembered."""
FEW: Final = np.float32(10.0)
"""Pixels of a colour that must have been seen before it says much."""
SURELY_BACKGROUND: Final = np.float32(2.5)
"""Spreads from the background, shadows forgiven, below which a pixel's colour counts as its own."""


def fresh() -> Floats:
    """(2, SHADES) counts of the background's and of the body's colours, before a person came."""
    return np.zeros((2, SHADES), np.float32)


@KERNEL
def body_colours_of(counts: Floats) -> Floats:
    """(SHADES,) from -1, only the background has this colour, to 1, only the body has it."""
    return (counts[1] - counts[0]) / (counts[0] + counts[1] + FEW)


@KERNEL
def counted(
    counts: Floats, inside: Bytes, frame: Image, model: BackgroundModel, cells: Bytes, cell: int
) -> Floats:
    """The counts after one more frame; `inside` counts the mask in 3x3 neighbourhoods."""
    background, weight, light = model.centre, model.weight, light_of(model.gain)
    height, width = inside.shape
    out = counts * KEPT
    for i, j in np.argwhere(cells):
        for y in range(i * cell, min((i + 1) * cell, height)):
            given, empty, weights = frame[y], background[y], weight[y]
            # every other pixel, like a chessboard, says as much
            for x in range(j * cell + (y & 1), min((j + 1) * cell, width), 2):
                if inside[y, x] == 9:
                    out[1, shade_of(given, light, x)] += 1
                elif inside[y, x] == 0:
                    far = unshaded(given, empty, weights, light, x)
                    if far < SURELY_BACKGROUND * SURELY_BACKGROUND:
                        out[0, shade_of(given, light, x)] += 1
    return out
