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


@numba.njit(cache=True)
def outline(frame: Any, long: float, short: float, height: float, view: Any, out: Any) -> bool:
    """A limb's outline in a view, as a PRIMITIVE; False where it is not before the camera.

    Args:
        frame: The limb's frame, (FRAME,).
        long: Half width along the limb's x axis, metres.
        short: Half width along its z axis.
        height: Length along its y axis.
        view: (VIEW,).
        out: (PRIMITIVE,), written.
    """
    ax, ay, az = view[9], view[10], view[11]
    ux = uy = uz = sxx = sxy = syy = 0.0
    for j in range(3):
        ax += view[j] * frame[j]
        ay += view[3 + j] * frame[j]
        az += view[6 + j] * frame[j]
        axis = frame[4 + 3 * j] * height
        ux += view[j] * axis
        uy += view[3 + j] * axis
        uz += view[6 + j] * axis
    for column, radius in ((0, long), (2, short)):
        px = py = 0.0
        for j in range(3):
            px += view[j] * frame[3 + 3 * j + column]
            py += view[3 + j] * frame[3 + 3 * j + column]
        px, py = px * radius * view[12], py * radius * view[13]
        sxx += px * px
        sxy += px * py
        syy += py * py
    depth_a = depth_b = view[16]
    if depth_a == 0.0:
        depth_a, depth_b = az, az + uz
        if depth_a < 0.05 or depth_b < 0.05:
            return False
    half_height = max(math.sqrt(syy), THINNEST * math.sqrt(sxx))
    shear = sxy / (half_height * half_height)
    half_width = math.sqrt(max(sxx - shear * sxy, THINNEST * THINNEST * sxx))
    stretch = half_width / half_height
    out[1] = ay / depth_a * view[13] + view[15]
    out[4] = (ay + uy) / depth_b * view[13] + view[15]
    out[0] = (ax / depth_a * view[12] + view[14] - shear * out[1]) / stretch
    out[3] = ((ax + ux) / depth_b * view[12] + view[14] - shear * out[4]) / stretch
    out[2] = half_height / depth_a
    out[5] = half_height / depth_b
    out[6] = shear
    out[7] = stretch
    return True


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
def spans(p: Any, width: int, height: int, first: Any, last: Any) -> tuple[int, int]:
    """Row intervals of a limb: first and last pixel of each row, cut to the picture.

    Args:
        p: (PRIMITIVE,).
        width: Of the picture, pixels.
        height: Of the picture.
        first: (height,) int32, written for the rows that are returned; `last` likewise. A row
            without a pixel has first > last.

    Returns:
        (top, bottom): the rows from top to bottom - 1 are written; the limb is in no other.
    """
    ax, ay, ra, bx, by, rb = p[0], p[1], p[2] + EDGE, p[3], p[4], p[5] + EDGE
    shear, stretch = p[6], p[7]
    top = min(height, max(0, math.ceil(min(ay - ra, by - rb) - 0.5)))
    bottom = min(height, math.floor(max(ay + ra, by + rb) - 0.5) + 1)
    dx, dy = bx - ax, by - ay
    length_2, taper = dx * dx + dy * dy, ra - rb
    # The two tangent lines, each x = at + slope y on rows from..to: a left or a right bound, or,
    # where the taper is strong and the limb lies flat, both on the same side.
    from_1 = from_2 = 1.0
    to_1 = to_2 = 0.0
    at_1 = at_2 = slope_1 = slope_2 = 0.0
    left_1 = left_2 = False
    if length_2 > taper * taper:
        sin_a = taper / length_2
        cos_a = math.sqrt(length_2 - taper * taper) / length_2
        nx, ny = dx * sin_a - dy * cos_a, dy * sin_a + dx * cos_a
        if nx != 0.0:
            from_1, to_1 = min(ay + ra * ny, by + rb * ny), max(ay + ra * ny, by + rb * ny)
            slope_1, left_1 = -ny / nx, nx < 0.0
            at_1 = ax + ra * nx - slope_1 * (ay + ra * ny)
        nx, ny = dx * sin_a + dy * cos_a, dy * sin_a - dx * cos_a
        if nx != 0.0:
            from_2, to_2 = min(ay + ra * ny, by + rb * ny), max(ay + ra * ny, by + rb * ny)
            slope_2, left_2 = -ny / nx, nx < 0.0
            at_2 = ax + ra * nx - slope_2 * (ay + ra * ny)
    ra_2, rb_2 = ra * ra, rb * rb
    for row in range(top, bottom):
        y = row + 0.5
        on_1, on_2 = from_1 <= y <= to_1, from_2 <= y <= to_2
        low, high = math.inf, -math.inf
        if not (on_1 and on_2 and left_1 != left_2):
            square = ra_2 - (y - ay) * (y - ay)
            if square >= 0.0:
                reach = math.sqrt(square)
                low, high = ax - reach, ax + reach
            square = rb_2 - (y - by) * (y - by)
            if square >= 0.0:
                reach = math.sqrt(square)
                low, high = min(low, bx - reach), max(high, bx + reach)
        if on_1:
            x = at_1 + slope_1 * y
            if left_1:
                low = x
            else:
                high = x
        if on_2:
            x = at_2 + slope_2 * y
            if left_2:
                low = min(low, x)
            else:
                high = max(high, x)
        if low > high:
            first[row], last[row] = 1, 0
            continue
        offset = shear * y - 0.5
        from_x, to_x = stretch * low + offset, stretch * high + offset
        first[row] = math.ceil(min(max(from_x, 0.0), float(width)))
        last[row] = math.floor(max(min(to_x, width - 1.0), -1.0))
    return top, max(top, bottom)


@numba.njit(cache=True)
def _word(first: int, last: int, word: int) -> Any:
    """The bits of the pixels first..last that fall into a word; the interval meets it."""
    low = max(first - 64 * word, 0)
    high = min(last - 64 * word, 63)
    ones = np.uint64(0xFFFFFFFFFFFFFFFF)
    return (ones << np.uint64(low)) & (ones >> np.uint64(63 - high))


@numba.njit(cache=True)
def draw(first: Any, last: Any, top: int, bottom: int, bits: Any) -> None:
    """OR row intervals into packed rows (H, words)."""
    for row in range(top, bottom):
        a, b = first[row], last[row]
        if a <= b:
            for word in range(a >> 6, (b >> 6) + 1):
                bits[row, word] |= _word(a, b, word)


@numba.njit(cache=True)
def gain(
    firsts: Any, lasts: Any, top: int, bottom: int, limbs: int, base: Any, seen: Any
) -> tuple[int, int]:
    """What limbs add to a drawn rest: (pixels newly drawn, those of them that are seen).

    Args:
        firsts: (limbs, H) first pixels of each limb's rows, `lasts` likewise; rows outside a
            limb have first > last.
        top: First row that any of them has.
        bottom: One past the last.
        limbs: How many.
        base: The rest, packed.
        seen: The silhouette, packed.
    """
    drawn = hit = 0
    for row in range(top, bottom):
        low, high = 1 << 30, -1
        for limb in range(limbs):
            if firsts[limb, row] <= lasts[limb, row]:
                low = min(low, firsts[limb, row])
                high = max(high, lasts[limb, row])
        for word in range(low >> 6, (high >> 6) + 1):
            new = np.uint64(0)
            for limb in range(limbs):
                a, b = firsts[limb, row], lasts[limb, row]
                if a <= b and a >> 6 <= word <= b >> 6:
                    new |= _word(a, b, word)
            new &= ~base[row, word]
            drawn += popcount(new)
            hit += popcount(new & seen[row, word])
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
def limb_outline(frames: Any, body: Any, limb: int, view: Any, out: Any) -> bool:
    """Outline of a placed limb: arms are round-ended, the others flat-ended cylinders (P5)."""
    long, short, height = limb_size(body, limb)
    if not outline(frames[limb], long, short, height, view, out):
        return False
    if limb >= 6:
        shear, stretch = out[6], out[7]
        out[0] = stretch * out[0] + shear * out[1]
        out[3] = stretch * out[3] + shear * out[4]
        depth_a = depth_b = view[16]
        if depth_a == 0.0:
            depth_a = depth_b = view[11]
            for j in range(3):
                depth_a += view[6 + j] * frames[limb, j]
                depth_b += view[6 + j] * (frames[limb, j] + height * frames[limb, 4 + 3 * j])
        out[2] = long * view[12] / depth_a
        out[5] = long * view[12] / depth_b
        out[6], out[7] = 0.0, 1.0
    return True


@numba.njit(cache=True)
def draw_limbs(body: Any, pose: Any, view: Any, limbs: int, width: int, bits: Any) -> None:
    """OR some limbs (as bits of LIMBS) of a posed body into packed rows (H, words)."""
    height = bits.shape[0]
    frames = np.empty((10, FRAME))
    place_limbs(body, pose, limbs, frames)
    p = np.empty(PRIMITIVE)
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    for limb in range(10):
        if limbs >> limb & 1 and limb_outline(frames, body, limb, view, p):
            top, bottom = spans(p, width, height, first, last)
            draw(first, last, top, bottom, bits)


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
