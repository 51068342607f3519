"""The matching kernel: limbs as row intervals of packed bits, and the score of a match.

A limb's outline is the hull of two discs in a picture whose rows are sheared and stretched so
that the limb's elliptic section becomes a circle. A pixel belongs to it when its centre does
(centre of the top-left pixel: (0.5, 0.5)); a centre within EDGE of the outline counts as inside,
so that rounding cannot split this rule from its definition (`inside`). Masks are packed 64 pixels
a word, union is OR, counting is popcount.

Source: Huang & Chung 2004, section 2.3; design: exact pixel-centre rule.
"""

import math
import time
from typing import Any, Final

import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from common.body import LIMBS, Vector, body_vector, rest_pose, thesis_bdp
from common.camera import Camera
from common.kinematics import ALL_LIMBS, FRAME, place_limbs
from common.similarity import Mask

Bits = NDArray[np.uint64]
EDGE: Final = 1e-9
THINNEST: Final = 1e-3
"""Least height of a section in the picture, as a share of its width: flat ends stay finite."""

LANES: Final = 8
"""Rows that a processor takes at once: a whole number of them needs no slow remainder."""
NEAREST_M: Final = 0.05
"""A limb that reaches nearer to the camera, or behind it, is not drawn."""

VIEW: Final = 17
"""A view: R (9), t (3), focal x, y (px), centre x, y (px), depth (m; 0: true perspective)."""
PRIMITIVE: Final = 8
"""A limb in the picture: x, y, r of one disc, of the other, shear, stretch."""


@intrinsic
def popcount(_context: Any, _word: Any) -> Any:
    """Number of ones in a word."""

    def generate(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        counter = builder.module.declare_intrinsic("llvm.ctpop", [ir.IntType(64)])
        return builder.call(counter, arguments)

    return types.int64(types.uint64), generate


def inside(primitive: Vector, x_px: float, y_px: float) -> bool:
    """Whether a point of the picture lies in a limb: the definition that the kernel is held to.

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


@numba.njit(cache=True)
def _tangent(p: Any, nx: float, ny: float) -> tuple[float, float, float, float]:
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


@numba.njit(cache=True)
def _cut_first(x: float, width: int) -> Any:
    """First pixel of the picture whose centre is not left of x + 0.5; width where there is none."""
    return np.int32(np.ceil(min(max(x, 0.0), float(width))))


@numba.njit(cache=True)
def _cut_last(x: float, width: int) -> Any:
    """Last pixel whose centre is not right of x + 0.5; -1 where there is none."""
    return np.int32(np.floor(max(min(x, width - 1.0), -1.0)))


@numba.njit(cache=True)
def _rows_of_steep(
    p: Any, left: Any, right: Any, begin: int, end: int, width: int, first: Any, last: Any
) -> None:
    """Row intervals of a limb with a tangent on either side: that, and each end's disc beyond it.

    The loop has no branches and no order, so that a processor takes several rows at once.
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


@numba.njit(cache=True)
def _rows_of_all(
    p: Any, one: Any, other: Any, begin: int, end: int, width: int, first: Any, last: Any
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


@numba.njit(cache=True)
def spans(p: Any, width: int, height: int, first: Any, last: Any) -> tuple[int, int]:
    """Row intervals of a limb: first and last pixel of each row, cut to the picture.

    A limb is mostly so steep that rows lie between its tangents: then one of these is its left
    side and one its right, and the rows of each end are one disc's.

    Args:
        p: (PRIMITIVE,).
        width: Of the picture, pixels.
        height: Of the picture.
        first: (height,) int32, written for the rows that are returned; `last` likewise. A row
            without a pixel has first > last.

    Returns:
        (top, bottom): the rows from top to bottom - 1 are written; the limb is in no other.
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


@numba.njit(cache=True)
def draw(first: Any, last: Any, top: int, bottom: int, bits: Any) -> None:
    """OR row intervals into packed rows (H, words)."""
    ones = np.uint64(0xFFFFFFFFFFFFFFFF)
    for row in range(top, bottom):
        a, b = first[row], last[row]
        if a <= b:
            new = ones << np.uint64(a & 63)
            for word in range(a >> 6, b >> 6):
                bits[row, word] |= new
                new = ones
            bits[row, b >> 6] |= new & ones >> np.uint64(63 - (b & 63))


@numba.njit(cache=True)
def gain(first: Any, last: Any, top: int, bottom: int, base: Any, seen: Any) -> tuple[int, int]:
    """What a limb adds to a drawn rest: (pixels newly drawn, those of them that are seen).

    Args:
        first: (H,) first pixels of the limb's rows, `last` likewise.
        top: The limb's first row.
        bottom: One past its last.
        base: The rest, packed.
        seen: The silhouette, packed.
    """
    ones = np.uint64(0xFFFFFFFFFFFFFFFF)
    drawn = hit = 0
    for row in range(np.uint64(top), np.uint64(bottom)):
        if first[row] <= last[row]:
            a, b = np.uint64(first[row]), np.uint64(last[row])
            new, begin, end = ones << (a & np.uint64(63)), a >> np.uint64(6), b >> np.uint64(6)
            while begin < end:
                new &= ~base[row, begin]
                drawn += popcount(new)
                hit += popcount(new & seen[row, begin])
                new = ones
                begin += np.uint64(1)
            new &= ones >> (np.uint64(63) - (b & np.uint64(63))) & ~base[row, end]
            drawn += popcount(new)
            hit += popcount(new & seen[row, end])
    return drawn, hit


@numba.njit(cache=True)
def score(hit: int, drawn: int, seen: int) -> float:
    """S of eq. (1) from counts of pixels: in both, in the model, in the silhouette (P9)."""
    union = drawn + seen - hit
    if union <= 0:
        return 0.0
    p = (seen - hit) / union
    return math.exp(-p - (drawn - hit) / union) * (1.0 - p)


@numba.njit(cache=True)
def limb_size(body: Any, limb: int) -> tuple[float, float, float]:
    """Half width, half depth and height of a limb from the body vector."""
    if limb < 6:
        return body[3 * limb], body[3 * limb + 1], body[3 * limb + 2]
    at = 18 + 2 * (limb - 6)
    return body[at], body[at], body[at + 1]


@numba.njit(cache=True)
def _section(
    frames: Any, limb: int, long: float, short: float, view: Any
) -> tuple[float, float, float]:
    """(shear, stretch, half height at depth 1) of a limb's elliptic section in a view."""
    sxx = sxy = syy = 0.0
    for column, radius in ((3, long), (5, short)):
        px = py = 0.0
        for j in range(3):
            px += view[j] * frames[limb, 3 * j + column]
            py += view[3 + j] * frames[limb, 3 * j + column]
        px, py = px * radius * view[12], py * radius * view[13]
        sxx += px * px
        sxy += px * py
        syy += py * py
    half_height = max(math.sqrt(syy), THINNEST * math.sqrt(sxx))
    shear = sxy / (half_height * half_height)
    half_width = math.sqrt(max(sxx - shear * sxy, THINNEST * THINNEST * sxx))
    return shear, half_width / half_height, half_height


@numba.njit(cache=True)
def limb_outline(frames: Any, body: Any, limb: int, view: Any, out: Any) -> bool:
    """Outline of a placed limb: arms are round-ended, the others flat-ended cylinders (P5).

    Args:
        frames: (10, FRAME).
        body: Body vector.
        limb: Which one, as in LIMBS.
        view: (VIEW,).
        out: (PRIMITIVE,), written.

    Returns:
        False where it is not before the camera.
    """
    long, short, height = limb_size(body, limb)
    ax, ay, depth_a = view[9], view[10], view[11]
    bx = by = depth_b = 0.0
    for j in range(3):
        origin, axis = frames[limb, j], frames[limb, 4 + 3 * j] * height
        ax, bx = ax + view[j] * origin, bx + view[j] * axis
        ay, by = ay + view[3 + j] * origin, by + view[3 + j] * axis
        depth_a, depth_b = depth_a + view[6 + j] * origin, depth_b + view[6 + j] * axis
    bx, by, depth_b = ax + bx, ay + by, depth_a + depth_b
    if view[16] != 0.0:
        depth_a = depth_b = view[16]
    elif depth_a < NEAREST_M or depth_b < NEAREST_M:
        return False
    shear, stretch, half_height = 0.0, 1.0, long * view[12]
    if limb < 6:
        shear, stretch, half_height = _section(frames, limb, long, short, view)
    share_a, share_b = 1.0 / depth_a, 1.0 / depth_b
    out[1] = ay * share_a * view[13] + view[15]
    out[4] = by * share_b * view[13] + view[15]
    out[0] = (ax * share_a * view[12] + view[14] - shear * out[1]) / stretch
    out[3] = (bx * share_b * view[12] + view[14] - shear * out[4]) / stretch
    out[2], out[5] = half_height * share_a, half_height * share_b
    out[6], out[7] = shear, stretch
    return True


@numba.njit(cache=True)
def draw_placed(frames: Any, body: Any, view: Any, limbs: int, width: int, bits: Any) -> None:
    """OR some placed limbs (as bits of LIMBS) into packed rows (H, words)."""
    height = bits.shape[0]
    p = np.empty(PRIMITIVE)
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    for limb in range(10):
        if limbs >> limb & 1 and limb_outline(frames, body, limb, view, p):
            top, bottom = spans(p, width, height, first, last)
            draw(first, last, top, bottom, bits)


@numba.njit(cache=True)
def draw_limbs(body: Any, pose: Any, view: Any, limbs: int, width: int, bits: Any) -> None:
    """OR some limbs of a posed body into packed rows (H, words)."""
    frames = np.empty((10, FRAME))
    place_limbs(body, pose, limbs, frames)
    draw_placed(frames, body, view, limbs, width, bits)


@numba.njit(cache=True)
def count(bits: Any) -> int:
    """Number of pixels in packed rows."""
    total = 0
    for row in range(bits.shape[0]):
        for word in range(bits.shape[1]):
            total += popcount(bits[row, word])
    return total


@numba.njit(cache=True)
def count_both(one: Any, other: Any) -> int:
    """Number of pixels that two packed masks share."""
    total = 0
    for row in range(one.shape[0]):
        for word in range(one.shape[1]):
            total += popcount(one[row, word] & other[row, word])
    return total


def pack_words(mask: Mask) -> Bits:
    """A mask (H, W) as rows of 64-pixel words, (H, ceil(W / 64))."""
    packed = np.packbits(mask, axis=1, bitorder="little")
    return words_of_rows(packed.tobytes(), mask.shape[1], mask.shape[0])


def words_of_rows(packed: bytes, width: int, height: int) -> Bits:
    """Rows of whole bytes, the first pixel lowest (`Report.silhouette`), as rows of words."""
    rows = np.zeros((height, 8 * ((width + 63) // 64)), np.uint8)
    rows[:, : (width + 7) // 8] = np.frombuffer(packed, np.uint8).reshape(height, -1)
    return rows.view("<u8").astype(np.uint64, copy=False)


def unpack_words(bits: Bits, width: int) -> Mask:
    """The mask (H, width) of packed rows."""
    rows = np.ascontiguousarray(bits).view(np.uint8)
    return np.unpackbits(rows, axis=1, count=width, bitorder="little").astype(np.bool_)


def view_of(camera: Camera, depth_m: float = 0.0) -> Vector:
    """A camera as the kernel wants it; with a depth: scaled orthography at that depth (T19)."""
    K = camera.K
    tail = [K[0][0], K[1][1], K[0][2], K[1][2], depth_m]
    return np.concatenate([np.ravel(camera.R), camera.t, tail]).astype(np.float64)


def draw_body(body: Vector, pose: Vector, view: Vector, size: tuple[int, int]) -> Mask:
    """The picture of the body: a mask (H, W) of its ten cylinders."""
    width, height = size
    bits = np.zeros((height, (width + 63) // 64), np.uint64)
    draw_limbs(body, pose, view, ALL_LIMBS, width, bits)
    return unpack_words(bits, width)


def warm() -> float:
    """Compile the kernel or load it from numba's cache; returns the seconds that it took."""
    began = time.perf_counter()
    view = np.concatenate([np.eye(3).ravel(), np.zeros(3), [100.0, 100.0, 80.0, 60.0, 4.0]])
    draw_body(body_vector(thesis_bdp(1.75)), rest_pose(), view, (160, 120))
    return time.perf_counter() - began


if __name__ == "__main__":
    print(f"the matching kernel of {len(LIMBS)} limbs is compiled ({warm():.1f} s)")
