"""Where exactly the outline runs: the share of every pixel on it that is body."""

from typing import Final

import numpy as np

from viewer.difference import BLUE, GREEN, INLINE, KERNEL, ONE, RED, SURE, WHITE, Bytes, settle
from viewer.stacks import Floats, Frame

Colour = tuple[np.float32, np.float32, np.float32, np.float32]
NEAR: Final = np.exp(-np.arange(9, dtype=np.float32) / np.float32(2 * 1.2**2))
"""Weight of a neighbour, by its squared distance in strides."""
DEEP: Final = np.arange(10, dtype=np.float32) ** 2
"""Weight of a neighbour, by how many of its 3x3 neighbourhood are on its side."""
OUTLINE_PULL: Final = np.float32(0.15)
"""The same where the outline is drawn."""
COVERED: Final = np.float32(0.3)
"""Share of a pixel that the body must cover."""
COLOUR: Final = np.float32(0.4)
"""What colour counts beside brightness at an outline: cameras and codecs blur colour twofold."""
GREY_LEVELS: Final = np.float32(10.0)
"""Difference at an outline that is worth one unit of evidence."""
STRANGE: Final = np.float32(8.0)
"""Grey levels off the line from room to body at which a pixel is a third thing: body too."""
THIRD: Final = np.float32(0.75)
"""What a grey level of that counts."""
NOISE: Final = np.float32(25.0)
"""Grey levels squared: where body and room differ by no more, the outline stays undecided."""
DIMMEST, BRIGHTEST = np.float32(0.5), np.float32(1.1)
"""Shade that is believed of the room beside a body."""


@KERNEL
def redraw(
    mask: Bytes, inside: Bytes, frame: Frame, room: Floats, gain: Floats, cells: Bytes, cell: int
) -> None:
    """Draw the outline where the colours around say: what share of a pixel is body?

    `inside` counts the mask in every pixel's 3x3 neighbourhood.
    """
    height, width = mask.shape
    evidence = np.zeros((height, width), np.float32)
    for i, j in np.argwhere(cells):
        for y in range(i * cell, min((i + 1) * cell, height)):
            for x in range(j * cell, min((j + 1) * cell, width)):
                if 0 < inside[y, x] < 9:
                    stride = max(1, cell // 2)
                    evidence[y, x] = _covered(mask, inside, frame, room, gain, y, x, stride)
                else:
                    evidence[y, x] = ONE if mask[y, x] else -ONE
    settle(mask, evidence, cells, cell, OUTLINE_PULL)


@INLINE
def _covered(
    mask: Bytes,
    inside: Bytes,
    frame: Frame,
    room: Floats,
    gain: Floats,
    y: int,
    x: int,
    stride: int,
) -> np.float32:
    """Evidence that the body covers a pixel of the outline.

    The pixel mixes the body's colour nearby with its own room, in the shade of the room nearby.
    """
    body, shade = _around(mask, inside, frame, room, gain, y, x, stride)
    if body[3] == 0:
        return -SURE
    part = ONE / body[3]
    due_b = min(room[y, x, 0] * gain[0], WHITE) * shade
    due_g = min(room[y, x, 1] * gain[1], WHITE) * shade
    due_r = min(room[y, x, 2] * gain[2], WHITE) * shade
    off = _opponent(frame[y, x, 0] - due_b, frame[y, x, 1] - due_g, frame[y, x, 2] - due_r)
    full = _opponent(body[0] * part - due_b, body[1] * part - due_g, body[2] * part - due_r)
    square = _dot(full, full)
    share = _dot(off, full) / (square + NOISE)
    third = np.sqrt(max(_dot(off, off) - share * share * square, np.float32(0)))
    levels = (share - COVERED) * np.sqrt(square) + THIRD * max(third - STRANGE, np.float32(0))
    return min(max(levels / GREY_LEVELS, -SURE), SURE)


@INLINE
def _around(
    mask: Bytes,
    inside: Bytes,
    frame: Frame,
    room: Floats,
    gain: Floats,
    y: int,
    x: int,
    stride: int,
) -> tuple[Colour, np.float32]:
    """Sum of the body's colours near a pixel with the sum of their weights, and the room's shade.

    Pixels deep inside or outside weigh most: the mask is surest there.
    """
    height, width = mask.shape
    body_b = body_g = body_r = body = np.float32(0)
    bright = due = np.float32(1e-3)
    for i in range(-2, 3):
        v = min(max(y + i * stride, 0), height - 1)
        given, empty, sides, counts = frame[v], room[v], mask[v], inside[v]
        for j in range(-2 + (i & 1), 3, 2):
            u = min(max(x + j * stride, 0), width - 1)
            b, g, r = np.float32(given[u, 0]), np.float32(given[u, 1]), np.float32(given[u, 2])
            if sides[u]:
                w = NEAR[i * i + j * j] * DEEP[counts[u]]
                body_b, body_g, body_r = body_b + w * b, body_g + w * g, body_r + w * r
                body += w
            else:
                w = NEAR[i * i + j * j] * DEEP[9 - counts[u]]
                bright += w * (b + g + r)
                due += w * (empty[u, 0] * gain[0] + empty[u, 1] * gain[1] + empty[u, 2] * gain[2])
    shade = min(max(bright / due, DIMMEST), BRIGHTEST)
    return (body_b, body_g, body_r, body), shade


@INLINE
def _opponent(b: np.float32, g: np.float32, r: np.float32) -> Colour:
    """A difference as brightness and what is left of the three channels."""
    luma = BLUE * b + GREEN * g + RED * r
    return luma, COLOUR * (b - luma), COLOUR * (g - luma), COLOUR * (r - luma)


@INLINE
def _dot(a: Colour, b: Colour) -> np.float32:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
