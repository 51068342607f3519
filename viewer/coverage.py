"""What share of a pixel the body covers: a mix of its colour nearby and the shaded room."""

from typing import Final

import numpy as np

from viewer.difference import BLUE, GREEN, INLINE, KERNEL, ONE, RED, WHITE, Bytes
from viewer.stacks import Floats, Frame

Colour = tuple[np.float32, np.float32, np.float32, np.float32]
Beside = tuple[np.float32, np.float32, np.float32, np.float32, np.float32]
SIDES: Final = 6
"""Sums over a neighbourhood: see `sides_of`."""
SHARES: Final = 3
"""What is said of a pixel for its neighbours too: see `covered`."""
FACTS: Final = 4
"""What is said of a pixel of the band beside: see `covered`."""
COLOUR: Final = np.float32(0.4)
"""What colour counts beside brightness at an outline: cameras and codecs blur colour twofold."""
NOISE: Final = np.float32(25.0)
"""Grey levels squared: where body and room differ by no more, coverage says nothing."""
DIMMEST, BRIGHTEST = np.float32(0.5), np.float32(1.1)
"""Shade that is believed of the room beside a body."""
LEAST, MOST = np.float32(-0.5), np.float32(1.5)
"""Coverage is believed so far beyond none and whole."""
UNKNOWN: Final = np.float32(-1.0)
"""Coverage where no body is near."""
FEW: Final = np.float32(1e-3)
"""Less light, or less body, than any neighbourhood that has some."""
LEVELS, CONTRAST = np.float32(20.0), np.float32(100.0)
"""Grey levels that are worth a one, and beyond which contrast says no more."""


@KERNEL
def sides_of(
    frame: Frame, room: Floats, gain: Floats, inside: Bytes, top: int, left: int
) -> Floats:
    """(h, w, SIDES): colour and a one where the body is sure, light seen and due where the room is.

    `inside` counts the mask in every pixel's 3x3 neighbourhood, from (top, left) of the frame on.
    """
    height, width = inside.shape
    out = np.zeros((height, width, SIDES), np.float32)
    for y in range(height):
        given, empty = frame[y + top], room[y + top]
        for x in range(width):
            u = x + left
            b, g, r = np.float32(given[u, 0]), np.float32(given[u, 1]), np.float32(given[u, 2])
            if inside[y, x] == 9:
                out[y, x, 0], out[y, x, 1], out[y, x, 2], out[y, x, 3] = b, g, r, ONE
            elif inside[y, x] == 0:
                due_b, due_g, due_r = _due(empty, gain, u, ONE)
                out[y, x, 4] = BLUE * b + GREEN * g + RED * r
                out[y, x, 5] = BLUE * due_b + GREEN * due_g + RED * due_r
    return out


@KERNEL
def covered(
    frame: Frame,
    room: Floats,
    gain: Floats,
    sides: Floats,
    reach: Bytes,
    top: int,
    left: int,
) -> tuple[Floats, Floats]:
    """Coverage by colour and by brightness alone, and the difference from the shaded room.

    Args:
        frame: (H, W, 3).
        room: (H, W, 3) what it shows when empty, grey levels.
        gain: (3,) how much brighter than the room the frame is.
        sides: (h, w, SIDES) means of `sides_of` over a neighbourhood.
        reach: (h, w) 1 where to look, 2 in the band, whose pixels say more.
        top: Row of the frame where the others begin.
        left: Column of the frame where the others begin.

    Returns:
        (h, w, SHARES), and for the pixels of the band, row by row, (n, FACTS): contrast, that of
        brightness, what is off the line from room to body, shade.
    """
    height, width = reach.shape
    shares = np.empty((height, width, SHARES), np.float32)
    facts = np.empty((np.count_nonzero(reach == 2), FACTS), np.float32)
    n = 0
    for y in range(height):
        given, empty = frame[y + top], room[y + top]
        for x in range(width):
            if not reach[y, x]:
                continue
            beside = _beside(sides[y, x])
            off, full = _against(given, empty, gain, beside, x + left)
            square, light, at = _dot(full, full), full[0] * full[0], shares[y, x]
            at[0] = _share(_dot(off, full), square, beside)
            at[1] = _share(off[0] * full[0], light, beside)
            at[2] = min(abs(off[0]) / LEVELS, np.float32(2))
            if reach[y, x] == 2:
                there = ONE if beside[3] > 0 else np.float32(0)
                third = max(_dot(off, off) - at[0] * at[0] * square, np.float32(0))
                facts[n, 0] = there * min(np.sqrt(square), CONTRAST) / LEVELS
                facts[n, 1] = there * min(abs(full[0]), CONTRAST) / LEVELS
                facts[n, 2] = there * min(np.sqrt(third), CONTRAST) / LEVELS
                facts[n, 3] = beside[4]
                n += 1
    return shares, facts


@INLINE
def _due(
    empty: Floats, gain: Floats, x: int, shade: np.float32
) -> tuple[np.float32, np.float32, np.float32]:
    """What a pixel of a row of the room shows in this light and shade."""
    return (
        min(empty[x, 0] * gain[0], WHITE) * shade,
        min(empty[x, 1] * gain[1], WHITE) * shade,
        min(empty[x, 2] * gain[2], WHITE) * shade,
    )


@INLINE
def _beside(sides: Floats) -> Beside:
    """The body's colour in a neighbourhood, whether there is any, and the room's shade there."""
    shade = ONE
    if sides[5] > FEW:
        shade = min(max(sides[4] / sides[5], DIMMEST), BRIGHTEST)
    there = sides[3] > FEW
    part = ONE / sides[3] if there else np.float32(0)
    return sides[0] * part, sides[1] * part, sides[2] * part, np.float32(there), shade


@INLINE
def _against(
    given: Bytes, empty: Floats, gain: Floats, beside: Beside, x: int
) -> tuple[Colour, Colour]:
    """How a pixel, and how the body, differs from the room in its shade."""
    body_b, body_g, body_r, _, shade = beside
    b, g, r = _due(empty, gain, x, shade)
    seen_b, seen_g = np.float32(given[x, 0]), np.float32(given[x, 1])
    off = _opponent(seen_b - b, seen_g - g, np.float32(given[x, 2]) - r)
    return off, _opponent(body_b - b, body_g - g, body_r - r)


@INLINE
def _share(product: np.float32, square: np.float32, beside: Beside) -> np.float32:
    """Coverage, by the product of a pixel's difference with the body's, and the body's square."""
    share = min(max(product / (square + NOISE), LEAST), MOST)
    return share if beside[3] > 0 else UNKNOWN


@INLINE
def _opponent(b: np.float32, g: np.float32, r: np.float32) -> Colour:
    """A difference as brightness and what is left of the three channels."""
    luma = BLUE * b + GREEN * g + RED * r
    return luma, COLOUR * (b - luma), COLOUR * (g - luma), COLOUR * (r - luma)


@INLINE
def _dot(a: Colour, b: Colour) -> np.float32:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
