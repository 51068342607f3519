"""How far every pixel is from the background, shadows forgiven (section 1: subtraction)."""

from typing import Final

import numpy as np

from common.compiled import INLINE, KERNEL
from common.video.pictures import Image
from viewer.background.background import BackgroundModel
from viewer.background.image_stack import Bytes, Floats

Triple = tuple[np.float32, np.float32, np.float32]
BLUE, GREEN, RED = np.float32(0.114), np.float32(0.587), np.float32(0.299)
ONE, WHITE = np.float32(1.0), np.float32(255.0)

DIFFERS: Final = np.float32(4.75)
"""Distance from the background, in spreads, at which a pixel is as likely person as background."""
SEED: Final = np.float32(6.0)
"""Distance that only things reach: where it is passed, a region is looked for."""
DARKEST: Final = np.float32(0.7)
"""A soft shadow leaves at least this share of the light."""
SHADE: Final = np.float32(3.0)
"""Spreads by which a shadow may change the colour at equal brightness."""
STEEP: Final = np.float32(0.25)
"""Evidence of one spread."""
MOST_EVIDENCE: Final = np.float32(2.0)
"""Evidence stops here, so that one pixel cannot outvote its neighbours."""
KNOWN: Final = np.float32(1.0)
"""Evidence of a colour that only the body has."""
PULL: Final = np.float32(0.3)
"""What a neighbour at an edge weighs against a pixel's own evidence."""
DOUBTFUL: Final = np.float32(1.0)
"""A pixel and its neighbours that together speak less loudly are looked at again."""
CORNER: Final = np.float32(0.7)
"""What a neighbour at a corner weighs against one at an edge."""
FOLLOW: Final = np.float32(0.2)
"""Share of a difference that the background takes on then: a time constant of 2.4 s at 15 fps."""


@KERNEL
def seeds(frame: Image, model: BackgroundModel, cell: int) -> Bytes:
    """(rows, columns) of cells, 1 where one of two pixels of a cell is surely no background."""
    background, weight, light = model.centre, model.weight, light_of(model.gain)
    height, width = frame.shape[:2]
    out = np.zeros(((height + cell - 1) // cell, (width + cell - 1) // cell), np.uint8)
    for i in range(out.shape[0]):
        for k in (0, cell // 2):
            y = min(i * cell + k, height - 1)
            given, empty, weights, row = frame[y], background[y], weight[y], out[i]
            for j in range(len(row)):
                x = min(j * cell + k, width - 1)
                # whatever a shadow explains, it is no farther than without: most stop here
                if not row[j] and _distance(given, empty, weights, light, x) > SEED * SEED:
                    row[j] = unshaded(given, empty, weights, light, x) > SEED * SEED
    return out


@KERNEL
def label(
    mask: Bytes, doubt: Bytes, frame: Image, model: BackgroundModel, cells: Bytes, cell: int
) -> None:
    """Guess who is person inside the cells, by a pixel's evidence and its neighbours'.

    Sets the mask where they together speak for the person, and doubt where they hardly speak.
    """
    background, weight, light = model.centre, model.weight, light_of(model.gain)
    height, width = mask.shape
    evidence = np.zeros((height, width), np.float32)
    places, body_colours = np.argwhere(cells), model.body_colours
    for i, j in places:
        for y in range(i * cell, min((i + 1) * cell, height)):
            given, empty, weights = frame[y], background[y], weight[y]
            for x in range(j * cell, min((j + 1) * cell, width)):
                far = np.sqrt(unshaded(given, empty, weights, light, x))
                total = (far - DIFFERS) * STEEP + KNOWN * body_colours[shade_of(given, light, x)]
                evidence[y, x] = min(max(total, -MOST_EVIDENCE), MOST_EVIDENCE)
    for i, j in places:
        for y in range(i * cell, min((i + 1) * cell, height)):
            up, down = max(y - 1, 0), min(y + 1, height - 1)
            for x in range(j * cell, min((j + 1) * cell, width)):
                left, right = max(x - 1, 0), min(x + 1, width - 1)
                edges = evidence[up, x] + evidence[down, x] + evidence[y, left] + evidence[y, right]
                corners = evidence[up, left] + evidence[up, right]
                corners += evidence[down, left] + evidence[down, right]
                total = evidence[y, x] + PULL * (edges + CORNER * corners)
                mask[y, x], doubt[y, x] = total > 0, abs(total) < DOUBTFUL


@KERNEL
def adapted(frame: Image, model: BackgroundModel, corners: tuple[int, int, int, int]) -> Floats:
    """The background, a little nearer to what a frame shows outside (left, right, top, bottom)."""
    background, weight, light = model.centre, model.weight, light_of(model.gain)
    height, width = frame.shape[:2]
    left, right, top, bottom = corners
    out = background.copy()
    for y in range(height):
        given, empty, weights, now = frame[y], background[y], weight[y], out[y]
        for x in range(width):
            calm = _distance(given, empty, weights, light, x) < DIFFERS * DIFFERS
            near = (left <= x) & (x <= right) & (top <= y) & (y <= bottom)
            rate = FOLLOW if calm & (not near) else np.float32(0)
            b, g, r = _off(given, empty, light, x)
            now[x, 0] += rate * b / light[0]
            now[x, 1] += rate * g / light[1]
            now[x, 2] += rate * r / light[2]
    return out


@INLINE
def light_of(gain: Floats) -> Triple:
    """A gain that a loop need not read again after each write."""
    return gain[0], gain[1], gain[2]


@INLINE
def _off(given: Bytes, background: Floats, light: Triple, x: int) -> Triple:
    """How a pixel of a row differs from the background in this light, per channel."""
    return (
        np.float32(given[x, 0]) - min(background[x, 0] * light[0], WHITE),
        np.float32(given[x, 1]) - min(background[x, 1] * light[1], WHITE),
        np.float32(given[x, 2]) - min(background[x, 2] * light[2], WHITE),
    )


@INLINE
def _distance(
    given: Bytes, background: Floats, weight: Floats, light: Triple, x: int
) -> np.float32:
    """How far a pixel of a row is from the background, in spreads squared."""
    b, g, r = _off(given, background, light, x)
    luma = BLUE * b + GREEN * g + RED * r
    return luma * luma * weight[x, 0] + _square(b - luma, g - luma, r - luma) * weight[x, 1]


@INLINE
def brightness(
    given: Bytes, background: Floats, weight: Floats, light: Triple, x: int
) -> np.float32:
    """How much brighter than the background a pixel of a row is, in spreads."""
    b, g, r = _off(given, background, light, x)
    return (BLUE * b + GREEN * g + RED * r) * np.sqrt(weight[x, 0])


@INLINE
def colour(given: Bytes, background: Floats, weight: Floats, light: Triple, x: int) -> np.float32:
    """How far a pixel of a row is from the background by colour alone, in spreads squared."""
    b, g, r = _off(given, background, light, x)
    luma = BLUE * b + GREEN * g + RED * r
    return _square(b - luma, g - luma, r - luma) * weight[x, 1]


@INLINE
def unshaded(given: Bytes, background: Floats, weight: Floats, light: Triple, x: int) -> np.float32:
    """The same, but by colour alone where a soft shadow may lie: the background, only darker."""
    b, g, r = _off(given, background, light, x)
    # without the casts numba would go on in doubles
    due_b, due_g = np.float32(given[x, 0]) - b, np.float32(given[x, 1]) - g
    due_r = np.float32(given[x, 2]) - r
    luma = BLUE * b + GREEN * g + RED * r
    total = luma * luma * weight[x, 0] + _square(b - luma, g - luma, r - luma) * weight[x, 1]
    part = luma / max(BLUE * due_b + GREEN * due_g + RED * due_r, ONE)
    colour = _square(b - part * due_b, g - part * due_g, r - part * due_r) * weight[x, 1]
    shaded = (part < 0) & (part > DARKEST - ONE) & (colour < SHADE * SHADE)
    return min(colour, total) if shaded else total


@INLINE
def _square(b: np.float32, g: np.float32, r: np.float32) -> np.float32:
    return b * b + g * g + r * r


@INLINE
def shade_of(given: Bytes, light: Triple, x: int) -> int:
    """Number of a pixel's colour, under the background's light."""
    b = np.float32(given[x, 0]) / light[0]
    g = np.float32(given[x, 1]) / light[1]
    r = np.float32(given[x, 2]) / light[2]
    luma = BLUE * b + GREEN * g + RED * r
    bright = min(int(luma) >> 5, 7)
    blue = min(max((int(b - luma) + 64) >> 3, 0), 15)
    red = min(max((int(r - luma) + 64) >> 3, 0), 15)
    return (bright << 8) + (blue << 4) + red
