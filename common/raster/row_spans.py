"""A limb in the picture as row intervals: an exact rule, drawn and counted word by word.

A limb's contour is the hull of two discs in a picture whose rows are sheared and stretched so that
the limb's elliptic section becomes a circle. A pixel belongs to it when its centre does (centre of
the top-left pixel: (0.5, 0.5)). A centre within EDGE of the contour counts as inside: so rounding
cannot separate this rule from its definition (`inside`).

Source: design: exact pixel-centre rule; requirement P9.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.compiled import compiled
from common.raster.bits import ONES, Bits, popcount

Columns = NDArray[np.int32]
"""(H,): for each row of the picture, the first or the last pixel of an interval."""
Tangent = tuple[float, float, float, float]
"""A line that touches both discs: (at, slope, first y, last y), x = at + slope y."""

EDGE: Final = 1e-9

LANES: Final = 8
"""Number of rows that a processor handles at once: whole multiples need no slow remainder."""

PRIMITIVE: Final = 8
"""A limb in the picture: x, y, r of each of two discs, then shear and stretch."""


def inside(primitive: Vector, x_px: float, y_px: float) -> bool:
    """Whether a point of the picture lies in a limb: the definition that the kernel must match.

    In the sheared picture the limb is every disc of radius r(t) around c(t), 0 <= t <= 1, with
    c and r linear between its two ends.
    """
    ax, ay, ra, bx, by, rb, shear, stretch = (float(value) for value in primitive)
    px, py = (x_px - shear * y_px) / stretch - ax, y_px - ay
    length = math.hypot(bx - ax, by - ay)
    if length <= abs(ra - rb):
        t = 0.0 if ra >= rb else 1.0
    else:
        ux, uy = (bx - ax) / length, (by - ay) / length
        slope = (ra - rb) / math.sqrt(length * length - (ra - rb) ** 2)
        t = (px * ux + py * uy - abs(py * ux - px * uy) * slope) / length
        t = min(1.0, max(0.0, t))
    gap = math.hypot(px - t * (bx - ax), py - t * (by - ay)) - (ra + t * (rb - ra))
    return gap <= EDGE


@compiled
def _tangent(p: Vector, nx: float, ny: float) -> Tangent:
    """The line that touches both discs where their normal is (nx, ny): x = at + slope y.

    Returns:
        (at, slope, first y, last y); a level one bounds no row: its first y is beyond its last.
    """
    if nx == 0.0:
        return 0.0, 0.0, 1.0, 0.0
    ra, rb = p[2] + EDGE, p[5] + EDGE
    one, other = p[1] + ra * ny, p[4] + rb * ny
    slope = -ny / nx
    return p[0] + ra * nx - slope * one, slope, min(one, other), max(one, other)


@compiled
def _cut_first(x: float, width: int) -> np.int32:
    """First pixel whose centre is not left of x + 0.5; the width where there is none."""
    return np.int32(np.ceil(min(max(x, 0.0), float(width))))


@compiled
def _cut_last(x: float, width: int) -> np.int32:
    """Last pixel whose centre is not right of x + 0.5; -1 where there is none."""
    return np.int32(np.floor(max(min(x, width - 1.0), -1.0)))


@compiled
def _rows_of_steep(
    p: Vector,
    left: Tangent,
    right: Tangent,
    begin: int,
    end: int,
    width: int,
    first: Columns,
    last: Columns,
) -> None:
    """Row intervals of a limb with a tangent on either side: the tangents, and each end's disc
    beyond.

    The loop has no branches and no order, so that a processor handles several rows at once.
    """
    at_1, slope_1, from_1, to_1 = left
    at_2, slope_2, from_2, to_2 = right
    upper, lower = (0, 3) if p[1] <= p[4] else (3, 0)
    x_1, y_1, r_1 = p[upper], p[upper + 1], p[upper + 2] + EDGE
    x_2, y_2, r_2 = p[lower], p[lower + 1], p[lower + 2] + EDGE
    split, shear, stretch = max(from_1, from_2), p[6], p[7]
    for row in range(begin, end):
        y = row + 0.5
        x, off, r = (x_1, y - y_1, r_1) if y < split else (x_2, y - y_2, r_2)
        reach = math.sqrt(max(r * r - off * off, 0.0))
        low = at_1 + slope_1 * y if from_1 <= y <= to_1 else x - reach
        high = at_2 + slope_2 * y if from_2 <= y <= to_2 else x + reach
        offset = shear * y - 0.5
        first[row] = _cut_first(stretch * low + offset, width)
        last[row] = _cut_last(stretch * high + offset, width)


@compiled
def _rows_of_all(
    p: Vector,
    one: Tangent,
    other: Tangent,
    begin: int,
    end: int,
    width: int,
    first: Columns,
    last: Columns,
) -> None:
    """Row intervals of a limb of any shape: the outermost of both discs and both tangents."""
    for row in range(begin, end):
        y = row + 0.5
        low, high = math.inf, -math.inf
        for disc in range(0, 6, 3):
            r, off = p[disc + 2] + EDGE, y - p[disc + 1]
            if r * r >= off * off:
                reach = math.sqrt(r * r - off * off)
                low, high = min(low, p[disc] - reach), max(high, p[disc] + reach)
        for at, slope, begins, ends in (one, other):
            if begins <= y <= ends:
                low, high = min(low, at + slope * y), max(high, at + slope * y)
        offset = p[6] * y - 0.5
        first[row] = _cut_first(p[7] * low + offset, width)
        last[row] = _cut_last(p[7] * high + offset, width)


@compiled
def spans(p: Vector, width: int, height: int, first: Columns, last: Columns) -> tuple[int, int]:
    """Row intervals of a limb: first and last pixel of each row, cut to the picture.

    Most limbs are so steep that rows lie between the tangents: then one tangent is the left side
    and one the right, and the rows at each end belong to one disc.

    Args:
        p: (PRIMITIVE,).
        width: Of the picture, pixels.
        height: Of the picture.
        first: (height,) int32, written for the returned rows; `last` likewise. A row without a
            pixel has first > last.

    Returns:
        (top, bottom): rows top to bottom - 1 are written; the limb is in no other row.
    """
    ay, ra, by, rb = p[1], p[2] + EDGE, p[4], p[5] + EDGE
    top = min(height, max(0, math.ceil(min(ay - ra, by - rb) - 0.5)))
    bottom = max(top, min(height, math.floor(max(ay + ra, by + rb) - 0.5) + 1))
    dx, dy, taper = p[3] - p[0], by - ay, ra - rb
    length_2 = dx * dx + dy * dy
    nx_1 = ny_1 = nx_2 = ny_2 = 0.0
    if length_2 > taper * taper:
        sin_a = taper / length_2
        cos_a = math.sqrt(length_2 - taper * taper) / length_2
        nx_1, ny_1 = dx * sin_a - dy * cos_a, dy * sin_a + dx * cos_a
        nx_2, ny_2 = dx * sin_a + dy * cos_a, dy * sin_a - dx * cos_a
    left, right = _tangent(p, nx_1, ny_1), _tangent(p, nx_2, ny_2)
    if nx_1 * nx_2 >= 0.0 or max(left[2], right[2]) > min(left[3], right[3]):
        _rows_of_all(p, left, right, top, bottom, width, first, last)
        return top, bottom
    if nx_1 > 0.0:
        left, right = right, left
    whole = min(height, top + (bottom - top + LANES - 1) // LANES * LANES)
    _rows_of_steep(p, left, right, top, whole, width, first, last)
    return top, bottom


@compiled
def draw(first: Columns, last: Columns, top: int, bottom: int, bits: Bits) -> None:
    """OR row intervals into packed rows (H, words)."""
    for row in range(top, bottom):
        a, b = first[row], last[row]
        if a <= b:
            new = ONES << np.uint64(a & 63)
            for word in range(a >> 6, b >> 6):
                bits[row, word] |= new
                new = ONES
            bits[row, b >> 6] |= new & ONES >> np.uint64(63 - (b & 63))


@compiled
def gain(
    first: Columns, last: Columns, top: int, bottom: int, base: Bits, seen: Bits
) -> tuple[int, int]:
    """The pixels that a limb adds to a drawn rest: (number added, number of those that are seen).

    Args:
        first: (H,) first pixels of the limb's rows, `last` likewise.
        top: The limb's first row.
        bottom: One past its last.
        base: The rest, packed.
        seen: The silhouette, packed.
    """
    drawn = hit = 0
    for row in range(np.uint64(top), np.uint64(bottom)):
        if first[row] <= last[row]:
            a, b = np.uint64(first[row]), np.uint64(last[row])
            new, begin, end = ONES << (a & np.uint64(63)), a >> np.uint64(6), b >> np.uint64(6)
            while begin < end:
                new &= ~base[row, begin]
                drawn += popcount(new)
                hit += popcount(new & seen[row, begin])
                new = ONES
                begin += np.uint64(1)
            new &= ONES >> (np.uint64(63) - (b & np.uint64(63))) & ~base[row, end]
            drawn += popcount(new)
            hit += popcount(new & seen[row, end])
    return drawn, hit


@compiled
def undraw(top: int, bottom: int, base: Bits, bits: Bits) -> None:
    """Restore packed rows top to bottom - 1 to their state before limbs were drawn."""
    for row in range(top, bottom):
        for word in range(base.shape[1]):
            bits[row, word] = base[row, word]
