"""The matching kernel: a posed body's limbs in a view, drawn, and the score of a match.

Masks are packed (`bits`), a limb becomes row intervals (`spans`).

Source: Huang & Chung 2004, section 2.3.
"""

import math
import time
from functools import lru_cache
from typing import Final

import numpy as np

from common.body.body import LIMBS, Floats, Vector, rest_pose
from common.body.kinematics import ALL_LIMBS, FRAME, place_limbs
from common.body.proportions import ARMS, PER_ELLIPTIC, PER_ROUND, body_vector, thesis_bdp
from common.compiled import compiled
from common.raster.bits import Bits, blank, count, count_both, unpack_words
from common.raster.row_spans import PRIMITIVE, draw, spans
from common.raster.similarity import Mask
from common.rig.camera import Camera

R_UPPER_ARM: Final = LIMBS.index("r_upper_arm")
"""Index in LIMBS of the first round limb."""
THINNEST: Final = 1e-3
"""Least height of a section in the picture, as a share of its width: flat ends stay finite."""
NEAREST_M: Final = 0.05
"""A limb that reaches nearer to the camera, or behind it, is not drawn."""

ACROSS, DOWN, AHEAD = 0, 3, 6
"""Index in a view vector of the three rows of R, world to camera."""
SHIFT: Final = 9
"""Index in a view vector of t, world to camera, metres."""
FOCAL_X, FOCAL_Y, CENTRE_X, CENTRE_Y = 12, 13, 14, 15
"""Index in a view vector of the focal length and the centre, pixels."""
DEPTH: Final = 16
"""Index in a view vector of the depth of scaled orthography, metres; 0 there means true
perspective."""
VIEW: Final = 17
"""Length of a view vector."""


@compiled
def seen_at(view: Vector, x: float, y: float, z: float) -> tuple[float, float, float]:
    """(u, v, depth) of a world point in a view of true perspective; pixels, metres.

    A point nearer than NEAREST_M, or behind the camera, is projected as if at NEAREST_M.
    """
    depth = view[AHEAD] * x + view[AHEAD + 1] * y + view[AHEAD + 2] * z + view[SHIFT + 2]
    across = view[ACROSS] * x + view[ACROSS + 1] * y + view[ACROSS + 2] * z + view[SHIFT]
    down = view[DOWN] * x + view[DOWN + 1] * y + view[DOWN + 2] * z + view[SHIFT + 1]
    share = 1.0 / max(depth, NEAREST_M)
    u = across * share * view[FOCAL_X] + view[CENTRE_X]
    return u, down * share * view[FOCAL_Y] + view[CENTRE_Y], depth


@compiled
def score(hit: int, drawn: int, seen: int) -> float:
    """S of eq. (1) from counts of pixels: in both, in the model, in the silhouette (P9)."""
    union = drawn + seen - hit
    if union <= 0:
        return 0.0
    p = (seen - hit) / union
    return math.exp(-p - (drawn - hit) / union) * (1.0 - p)


@compiled
def limb_size(body: Vector, limb: int) -> tuple[float, float, float]:
    """Half width, half depth and height of a limb from the body vector."""
    if limb < R_UPPER_ARM:
        at = PER_ELLIPTIC * limb
        return body[at], body[at + 1], body[at + 2]
    at = ARMS + PER_ROUND * (limb - R_UPPER_ARM)
    return body[at], body[at], body[at + 1]


@compiled
def _section(
    frames: Floats, limb: int, long: float, short: float, view: Vector
) -> tuple[float, float, float]:
    """(shear, stretch, half height at depth 1) of a limb's elliptic section in a view."""
    sxx = sxy = syy = 0.0
    for column, radius in ((3, long), (5, short)):
        px = py = 0.0
        for j in range(3):
            px += view[ACROSS + j] * frames[limb, 3 * j + column]
            py += view[DOWN + j] * frames[limb, 3 * j + column]
        px, py = px * radius * view[FOCAL_X], py * radius * view[FOCAL_Y]
        sxx += px * px
        sxy += px * py
        syy += py * py
    half_height = max(math.sqrt(syy), THINNEST * math.sqrt(sxx))
    shear = sxy / (half_height * half_height)
    # a limb that lies exactly across the picture has a section of no width at all
    half_width = math.sqrt(max(sxx - shear * sxy, THINNEST * THINNEST * max(sxx, syy)))
    return shear, half_width / half_height, half_height


@compiled
def limb_primitive(frames: Floats, body: Vector, limb: int, view: Vector, out: Vector) -> bool:
    """Contour of a placed limb: arms are round-ended, the others flat-ended cylinders (P5).

    Args:
        frames: (10, FRAME).
        body: Body vector.
        limb: Index in LIMBS.
        view: (VIEW,).
        out: (PRIMITIVE,), written.

    Returns:
        False where the limb is not in front of the camera.
    """
    long, short, height = limb_size(body, limb)
    ax, ay, depth_a = view[SHIFT], view[SHIFT + 1], view[SHIFT + 2]
    bx = by = depth_b = 0.0
    for j in range(3):
        origin, axis = frames[limb, j], frames[limb, 4 + 3 * j] * height
        across, down, ahead = view[ACROSS + j], view[DOWN + j], view[AHEAD + j]
        ax, bx = ax + across * origin, bx + across * axis
        ay, by = ay + down * origin, by + down * axis
        depth_a, depth_b = depth_a + ahead * origin, depth_b + ahead * axis
    bx, by, depth_b = ax + bx, ay + by, depth_a + depth_b
    if view[DEPTH] != 0.0:
        depth_a = depth_b = view[DEPTH]
    elif depth_a < NEAREST_M or depth_b < NEAREST_M:
        return False
    shear, stretch, half_height = 0.0, 1.0, long * view[FOCAL_X]
    if limb < R_UPPER_ARM:
        shear, stretch, half_height = _section(frames, limb, long, short, view)
    share_a, share_b = 1.0 / depth_a, 1.0 / depth_b
    out[1] = ay * share_a * view[FOCAL_Y] + view[CENTRE_Y]
    out[4] = by * share_b * view[FOCAL_Y] + view[CENTRE_Y]
    out[0] = (ax * share_a * view[FOCAL_X] + view[CENTRE_X] - shear * out[1]) / stretch
    out[3] = (bx * share_b * view[FOCAL_X] + view[CENTRE_X] - shear * out[4]) / stretch
    out[2], out[5] = half_height * share_a, half_height * share_b
    out[6], out[7] = shear, stretch
    return True


@compiled
def draw_placed(
    frames: Floats, body: Vector, view: Vector, limbs: int, width: int, bits: Bits
) -> None:
    """OR some placed limbs (bits of LIMBS) into packed rows (H, words)."""
    height = bits.shape[0]
    p = np.empty(PRIMITIVE)
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    for limb in range(10):
        if limbs >> limb & 1 and limb_primitive(frames, body, limb, view, p):
            top, bottom = spans(p, width, height, first, last)
            draw(first, last, top, bottom, bits)


@compiled
def draw_limbs(
    body: Vector, pose: Vector, view: Vector, limbs: int, width: int, bits: Bits
) -> None:
    """OR some limbs of a posed body into packed rows (H, words)."""
    frames = np.empty((10, FRAME))
    place_limbs(body, pose, limbs, frames)
    draw_placed(frames, body, view, limbs, width, bits)


@compiled
def match(
    body: Vector, pose: Vector, view: Vector, limbs: int, width: int, seen: Bits, seen_px: int
) -> float:
    """S of a silhouette and some limbs of a posed body.

    Args:
        body: Body vector.
        pose: The 25 motion parameters.
        view: (VIEW,).
        limbs: Limbs as bits of LIMBS.
        width: Width of the picture, pixels.
        seen: The silhouette, packed (H, words).
        seen_px: Number of its pixels.
    """
    return match_over(np.zeros_like(seen), body, pose, view, limbs, width, seen, seen_px)


@compiled
def match_over(
    rest: Bits,
    body: Vector,
    pose: Vector,
    view: Vector,
    limbs: int,
    width: int,
    seen: Bits,
    seen_px: int,
) -> float:
    """The same where the rest (H, words) of the body is drawn already; the rest is not changed."""
    drawn = rest.copy()
    draw_limbs(body, pose, view, limbs, width, drawn)
    return score(count_both(drawn, seen), count(drawn), seen_px)


@lru_cache(maxsize=16)
def view_of(camera: Camera, depth_m: float = 0.0) -> Vector:
    """A camera as a view vector; with a depth: scaled orthography at that depth (T19)."""
    K = camera.K
    tail = [K[0][0], K[1][1], K[0][2], K[1][2], depth_m]
    return np.concatenate([np.ravel(camera.R), camera.t, tail]).astype(np.float64)


def draw_body(body: Vector, pose: Vector, view: Vector, size: tuple[int, int]) -> Mask:
    """The picture of the body: a mask (H, W) of its ten cylinders."""
    bits = blank(size)
    draw_limbs(body, pose, view, ALL_LIMBS, size[0], bits)
    return unpack_words(bits, size[0])


def warm() -> float:
    """Compile the kernel or load it from numba's cache; returns the seconds that took."""
    began = time.perf_counter()
    view = np.concatenate([np.eye(3).ravel(), np.zeros(3), [100.0, 100.0, 80.0, 60.0, 4.0]])
    draw_body(body_vector(thesis_bdp(1.75)), rest_pose(), view, (160, 120))
    return time.perf_counter() - began


if __name__ == "__main__":
    print(f"the matching kernel of {len(LIMBS)} limbs is compiled ({warm():.1f} s)")
