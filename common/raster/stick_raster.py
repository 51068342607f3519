"""The stick body drawn: its parts as primitives, and the pixels that parts add to a drawn rest."""

import math
from typing import Final

import numpy as np

from common.body.body import Floats, Vector
from common.body.stick_body import BREADTH, GIRTH, STATURE, Stickman, place_segments
from common.compiled import compiled
from common.raster.bits import Bits, blank, count, count_both, unpack_words
from common.raster.kernel import THINNEST, score
from common.raster.row_spans import PRIMITIVE, Columns, draw, gain, spans, undraw
from common.raster.similarity import Mask

ALL_SEGMENTS: Final = 0xFFF
"""Segments as bits: LIMBS, then the lines of the shoulders and of the hips."""
WITHOUT_ARMS: Final = 0b110000111111


@compiled
def _primitive(ends: Floats, part: Vector, pose: Vector, wide: float, out: Vector) -> None:
    """A part of the placed body in the form in which the kernel draws limbs (`row_spans`)."""
    row = int(part[0])
    ax, ay = ends[row, 0], ends[row, 1]
    dx, dy = ends[row, 2] - ax, ends[row, 3] - ay
    factor = pose[STATURE] * (wide if part[5] >= 2.0 else 1.0)
    if 2 <= row < 10:
        factor *= pose[GIRTH]
    out[0], out[1], out[2] = ax + part[1] * dx, ay + part[1] * dy, part[3] * factor
    out[3], out[4], out[5] = ax + part[2] * dx, ay + part[2] * dy, part[4] * factor
    out[6], out[7] = 0.0, 1.0
    length = math.hypot(dx, dy)
    if part[5] % 2.0 == 0.0 and length > 0.0:
        across, down = abs(dy) / length, abs(dx) / length
        height = max(down, THINNEST)
        shear = -dx * dy / (length * length) / (height * height)
        width = math.sqrt(max(across * across - shear * shear * height * height, THINNEST**2))
        out[2], out[5] = out[2] * height, out[5] * height
        out[6], out[7] = shear, width / height
        out[0] = (out[0] - shear * out[1]) / out[7]
        out[3] = (out[3] - shear * out[4]) / out[7]


@compiled
def widening(breadth: float, depth: float) -> float:
    """Apparent width of an elliptic trunk that shows this share of its breadth."""
    return math.sqrt(breadth * breadth + depth * depth * (1.0 - breadth * breadth))


@compiled
def draw_segments(
    ends: Floats, pose: Vector, parts: Floats, depth: float, which: int, width: int, bits: Bits
) -> None:
    """OR the parts of some placed segments (as bits) into packed rows (H, words)."""
    height = bits.shape[0]
    p = np.empty(PRIMITIVE)
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    wide = widening(pose[BREADTH], depth)
    for i in range(parts.shape[0]):
        if which >> int(parts[i, 0]) & 1:
            _primitive(ends, parts[i], pose, wide, p)
            top, bottom = spans(p, width, height, first, last)
            draw(first, last, top, bottom, bits)


@compiled
def added(
    ends: Floats,
    pose: Vector,
    parts: Floats,
    depth: float,
    which: int,
    width: int,
    rest: Bits,
    seen: Bits,
    scratch: Bits,
    first: Columns,
    last: Columns,
    p: Vector,
) -> tuple[int, int]:
    """The pixels that segments add to the drawn rest: (number added, number of those that are
    seen).

    `scratch` is a copy of the rest, before the call and after it.
    """
    height = seen.shape[0]
    highest, lowest = height, 0
    drawn = hit = 0
    wide = widening(pose[BREADTH], depth)
    for i in range(parts.shape[0]):
        if which >> int(parts[i, 0]) & 1:
            _primitive(ends, parts[i], pose, wide, p)
            top, bottom = spans(p, width, height, first, last)
            more_drawn, more_hit = gain(first, last, top, bottom, scratch, seen)
            drawn, hit = drawn + more_drawn, hit + more_hit
            draw(first, last, top, bottom, scratch)
            highest, lowest = min(highest, top), max(lowest, bottom)
    undraw(highest, lowest, rest, scratch)
    return drawn, hit


@compiled
def match_stick(
    lengths: Vector, parts: Floats, depth: float, pose: Vector, which: int, width: int, seen: Bits
) -> float:
    """S of a silhouette and some segments of the stick body (eq. 3.3)."""
    ends = np.empty((12, 4))
    place_segments(lengths, pose, ends)
    bits = np.zeros_like(seen)
    draw_segments(ends, pose, parts, depth, which, width, bits)
    return score(count_both(bits, seen), count(bits), count(seen))


def draw_stick(
    man: Stickman, pose: Vector, size: tuple[int, int], which: int = ALL_SEGMENTS
) -> Mask:
    """The picture of the stick body: a mask (H, W)."""
    width = size[0]
    ends, bits = np.empty((12, 4)), blank(size)
    place_segments(man.lengths, pose, ends)
    draw_segments(ends, pose, man.parts, man.depth, which, width, bits)
    return unpack_words(bits, width)
