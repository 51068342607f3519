"""What share of a pixel the body covers: a mix of its colour nearby and the shaded background."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.compiled import INLINE, KERNEL
from common.video.pictures import Image
from viewer.background.background import BackgroundModel
from viewer.background.image_stack import Bytes, Floats
from viewer.silhouette.difference import (
    BLUE,
    GREEN,
    ONE,
    RED,
    WHITE,
    Triple,
    brightness,
    colour,
    light_of,
    shade_of,
    unshaded,
)

Colour = tuple[np.float32, np.float32, np.float32, np.float32]
Beside = tuple[np.float32, np.float32, np.float32, np.float32, np.float32]
SIDES: Final = 6
"""Sums over a neighbourhood: see `sides_of`."""
SHARES: Final = 2
"""What is said of a pixel for its neighbours too: see `matte`."""
FACTS: Final = 8
"""What is said of a pixel of the band beside: see `_tell`."""
COLOUR: Final = np.float32(0.4)
"""What colour counts beside brightness at a contour: cameras and codecs blur colour twofold."""
NOISE: Final = np.float32(25.0)
"""Grey levels squared: where body and background differ by no more, alpha says nothing."""
DIMMEST, BRIGHTEST = np.float32(0.5), np.float32(1.1)
"""Shade that is believed of the background beside a body."""
HALF: Final = np.float32(0.5)
"""Rounds."""
LEAST, MOST = np.float32(-0.5), np.float32(1.5)
"""Alpha is believed so far beyond none and whole."""
UNKNOWN: Final = np.float32(-1.0)
"""Alpha where no body is near."""
FEW: Final = np.float32(1e-3)
"""Less light, or less body, than any neighbourhood that has some."""
LEVELS, CONTRAST = np.float32(20.0), np.float32(100.0)
"""Grey levels that are worth a one, and beyond which contrast says no more."""
SPREADS, FAR = np.float32(8.0), np.float32(20.0)
"""Spreads from the background that are worth a one, and beyond which distance says no more."""


@KERNEL
def sides_of(frame: Image, model: BackgroundModel, inside: Bytes, corner: tuple[int, int]) -> Bytes:
    """(h, w, SIDES): colour and a one inside the body, light seen and due inside the background.

    `inside` counts the mask in every pixel's 3x3 neighbourhood, from a row and column of the frame
    on.
    """
    background, light = model.centre, light_of(model.gain)
    height, width = inside.shape
    top, left = corner
    out = np.zeros((height, width, SIDES), np.uint8)
    for y in range(height):
        given, empty, side, row = frame[y + top], background[y + top], inside[y], out[y]
        for x in range(width):
            u = x + left
            b, g, r = np.float32(given[u, 0]), np.float32(given[u, 1]), np.float32(given[u, 2])
            if side[x] == 9:
                row[x, 0], row[x, 1], row[x, 2], row[x, 3] = (
                    given[u, 0],
                    given[u, 1],
                    given[u, 2],
                    1,
                )
            elif side[x] == 0:
                row[x, 4] = _level(b, g, r)
                due_b, due_g, due_r = _due(empty, light, u, ONE)
                row[x, 5] = _level(due_b, due_g, due_r)
    return out


@KERNEL
def matte(
    frame: Image,
    model: BackgroundModel,
    sides: Floats,
    reach: Bytes,
    corner: tuple[int, int],
) -> tuple[Floats, NDArray[np.int32], Floats]:
    """What share of a pixel the body covers, and how far it is from the shaded background.

    Args:
        frame: (H, W, 3).
        model: What it is held against.
        sides: (h, w, SIDES) means of `sides_of` over a neighbourhood.
        reach: (h, w) 1 where to look, 2 in the band, of whose pixels more is said.
        corner: Row and column of the frame where the window of sides and reach begins.

    Returns:
        (h, w, SHARES); row and column (n, 2) in the window of the pixels of the band; facts of them
        (n, FACTS).
    """
    background, weight, light = model.centre, model.weight, light_of(model.gain)
    height, width = reach.shape
    top, left = corner
    shares = np.empty((height, width, SHARES), np.float32)
    count = np.count_nonzero(reach == 2)
    places, facts = np.empty((count, 2), np.int32), np.empty((count, FACTS), np.float32)
    n, body_colours = 0, model.body_colours
    for y in range(height):
        given, empty, weights = frame[y + top], background[y + top], weight[y + top]
        for x in range(width):
            if not reach[y, x]:
                continue
            beside, u = _beside(sides[y, x]), x + left
            off, full = _against(given, empty, light, beside, u)
            share = UNKNOWN
            if beside[3] > 0:
                share = min(max(_dot(off, full) / (_dot(full, full) + NOISE), LEAST), MOST)
            shares[y, x, 0] = share
            shares[y, x, 1] = min(abs(off[0]) / LEVELS, np.float32(2))
            if reach[y, x] == 2:
                _tell(facts[n], off, full, share, beside)
                facts[n, 4] = _spreads(np.sqrt(unshaded(given, empty, weights, light, u)))
                facts[n, 5] = _spreads(brightness(given, empty, weights, light, u))
                facts[n, 6] = _spreads(np.sqrt(colour(given, empty, weights, light, u)))
                facts[n, 7] = body_colours[shade_of(given, light, u)]
                places[n, 0], places[n, 1] = y, x
                n += 1
    return shares, places, facts


@INLINE
def _tell(out: Floats, off: Colour, full: Colour, share: np.float32, beside: Beside) -> None:
    """Contrast of body and background, in brightness alone, what is off their line, and shade.

    `matte` adds the distance from the background with shadows forgiven, how much brighter and
    how much another colour that is, and whose colour.
    """
    square = _dot(full, full)
    third = max(_dot(off, off) - share * share * square, np.float32(0))
    part = beside[3] / LEVELS
    out[0] = part * min(np.sqrt(square), CONTRAST)
    out[1] = part * min(abs(full[0]), CONTRAST)
    out[2] = part * min(np.sqrt(third), CONTRAST)
    out[3] = beside[4]


@INLINE
def _spreads(far: np.float32) -> np.float32:
    return min(max(far, -FAR), FAR) / SPREADS


@INLINE
def _level(b: np.float32, g: np.float32, r: np.float32) -> np.uint8:
    return np.uint8(np.int32(BLUE * b + GREEN * g + RED * r + HALF))


@INLINE
def _due(
    empty: Floats, light: Triple, x: int, shade: np.float32
) -> tuple[np.float32, np.float32, np.float32]:
    """What a pixel of a row of the background shows in this light and shade."""
    return (
        min(empty[x, 0] * light[0], WHITE) * shade,
        min(empty[x, 1] * light[1], WHITE) * shade,
        min(empty[x, 2] * light[2], WHITE) * shade,
    )


@INLINE
def _beside(sides: Floats) -> Beside:
    """The body's colour in a neighbourhood, whether there is any, and the shade there."""
    shade = ONE
    if sides[5] > FEW:
        shade = min(max(sides[4] / sides[5], DIMMEST), BRIGHTEST)
    there = sides[3] > FEW
    part = ONE / sides[3] if there else np.float32(0)
    return sides[0] * part, sides[1] * part, sides[2] * part, np.float32(there), shade


@INLINE
def _against(
    given: Bytes, empty: Floats, light: Triple, beside: Beside, x: int
) -> tuple[Colour, Colour]:
    """How a pixel, and how the body, differs from the background in its shade."""
    body_b, body_g, body_r, _, shade = beside
    b, g, r = _due(empty, light, x, shade)
    seen_b, seen_g = np.float32(given[x, 0]), np.float32(given[x, 1])
    off = _opponent(seen_b - b, seen_g - g, np.float32(given[x, 2]) - r)
    return off, _opponent(body_b - b, body_g - g, body_r - r)


@INLINE
def _opponent(b: np.float32, g: np.float32, r: np.float32) -> Colour:
    """A difference as brightness and what is left of the three channels."""
    luma = BLUE * b + GREEN * g + RED * r
    return luma, COLOUR * (b - luma), COLOUR * (g - luma), COLOUR * (r - luma)


@INLINE
def _dot(a: Colour, b: Colour) -> np.float32:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
