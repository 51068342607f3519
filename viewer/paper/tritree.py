"""The overlapped tritree: the one-dimensional search behind every joint angle (section 3.5)."""

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np

from common.body.body import Floats, Vector
from common.body.kinematics import ALL_LIMBS, FRAME, hang_limbs, place_limbs
from common.compiled import compiled
from common.raster.bits import Bits, count, count_both
from common.raster.kernel import draw_placed, limb_primitive, score
from common.raster.row_spans import PRIMITIVE, Columns, draw, gain, spans, undraw

MOST_STAGES = 16
"""Largest number of stages: a window of 2^16 stops still ends (the guard of M14)."""


LOW, HIGH, LEFT, MIDDLE, RIGHT, ROUNDS, BEST_ANGLE, BEST_SCORE, MATCHES = range(9)
"""Layout of a search: its window, the scores at its ends and its middle (NaN: not matched yet),
the number of stages, and the best probe so far."""
MIDDLE_FIRST = (MIDDLE, LEFT, RIGHT)
"""Order of the probes: the first wins a tie, and the middle is the previous angle."""


Bound = TypeVar("Bound", int, float)
"""An end of a window, in stops or in degrees."""


class Found(NamedTuple):
    """The best angle of a search."""

    angle_deg: float
    score: float
    matches: int
    """Number of score computations; the paper's measure of cost."""


@compiled
def window(previous_deg: float, width_deg: int, low_deg: float, high_deg: float) -> tuple[int, int]:
    """The search window: around the previous angle, shifted into the joint's range.

    Bounds are whole degrees: with raw float bounds there is a stage more, and no match is reused
    (P36). A range narrower than the window is searched from its lower end.
    """
    half = width_deg // 2
    low, high = whole(low_deg), whole(high_deg)
    centre = min(max(whole(previous_deg), low + half), max(high - half, low + half))
    return centre - half, centre + half


@compiled
def whole(value: float) -> int:
    """The nearest whole number, halves upwards."""
    return int(np.floor(value + 0.5))


@compiled
def narrowed(
    low: Bound, high: Bound, left: float, middle: float, right: float
) -> tuple[Bound, Bound, float, float, float]:
    """The half window around the winner, with the scores that it inherits (NaN: not matched yet).

    A tie goes to the middle, then to the left: deterministic, and close to the previous angle.
    """
    quarter = (high - low) // 4
    if middle >= left and middle >= right:
        return low + quarter, high - quarter, np.nan, middle, np.nan
    if left >= right:
        return low, low + 2 * quarter, left, np.nan, middle
    return high - 2 * quarter, high, middle, np.nan, right


@compiled
def begun(low: float, high: float) -> Floats:
    """The layout LOW to MATCHES of a window before any match."""
    tree = np.full(MATCHES + 1, np.nan)
    tree[LOW], tree[HIGH], tree[ROUNDS] = low, high, 0.0
    tree[BEST_ANGLE], tree[BEST_SCORE], tree[MATCHES] = 0.5 * (low + high), -1.0, 0.0
    return tree


@compiled
def probe(tree: Vector, stop: float) -> int:
    """Which end or middle of a window to match next: LEFT, MIDDLE or RIGHT; -1: none.

    Each round compares the left end, the middle and the right end of the window and keeps the
    half around the winner. The halves overlap, and the winner is always a point of the next
    round, so at most two new matches are needed there.

    Args:
        tree: From `begun`; narrowed in place.
        stop: Width at which to stop.
    """
    while tree[HIGH] - tree[LOW] > stop and tree[ROUNDS] < MOST_STAGES:
        for i in MIDDLE_FIRST:
            if np.isnan(tree[i]):
                return i
        tree[LOW], tree[HIGH], tree[LEFT], tree[MIDDLE], tree[RIGHT] = narrowed(
            tree[LOW], tree[HIGH], tree[LEFT], tree[MIDDLE], tree[RIGHT]
        )
        tree[ROUNDS] += 1
    return -1


@compiled
def angle_of(tree: Vector, which: int) -> float:
    """The angle of a probe."""
    return tree[LOW] + (which - LEFT) * ((tree[HIGH] - tree[LOW]) // 2)


@compiled
def tell(tree: Vector, which: int, score: float) -> None:
    """Add the score of a probe."""
    tree[which] = score
    tree[MATCHES] += 1
    if score > tree[BEST_SCORE]:
        tree[BEST_ANGLE], tree[BEST_SCORE] = angle_of(tree, which), score


def tritree(
    score_at: Callable[[float], float], bounds_deg: tuple[int, int], stop_deg: int
) -> Found:
    """Best angle in a window, for any score.

    Args:
        score_at: Matching score of an angle in degrees; called once per angle.
        bounds_deg: (low, high) of the range to search: `stop_deg` times a power of two apart.
        stop_deg: Width at which to stop.

    Raises:
        ValueError: When a score is not a number: it is neither better nor worse than another.

    Source: Huang & Chung 2004, section 3.5, steps (1)-(6) (P36-P41).
    """
    tree = begun(*bounds_deg)
    while (which := probe(tree, stop_deg)) >= 0:
        angle_deg = angle_of(tree, which)
        matched = score_at(angle_deg)
        if np.isnan(matched):
            raise ValueError(f"the score of {angle_deg:g} degrees is not a number")
        tell(tree, which, matched)
    return Found(float(tree[BEST_ANGLE]), float(tree[BEST_SCORE]), int(tree[MATCHES]))


@compiled
def added(
    frames: Floats,
    body: Vector,
    view: Vector,
    moving: int,
    width: int,
    rest: Bits,
    seen: Bits,
    scratch: Bits,
    first: Columns,
    last: Columns,
    p: Vector,
) -> tuple[int, int]:
    """The pixels that placed limbs add to the drawn rest: (number added, number of those that are
    seen).

    Each limb counts over the rest and the limbs before it, so all but the last are drawn, into
    `scratch`, which equals the rest before and after.
    """
    height = seen.shape[0]
    highest, lowest = height, 0
    drawn = hit = 0
    for limb in range(10):
        if moving >> limb & 1 and limb_primitive(frames, body, limb, view, p):
            top, bottom = spans(p, width, height, first, last)
            more_drawn, more_hit = gain(first, last, top, bottom, scratch, seen)
            drawn, hit = drawn + more_drawn, hit + more_hit
            if moving >> (limb + 1):
                draw(first, last, top, bottom, scratch)
                highest, lowest = min(highest, top), max(lowest, bottom)
    undraw(highest, lowest, rest, scratch)
    return drawn, hit


@compiled
def search(
    seen: Bits,
    seen_px: int,
    width: int,
    body: Vector,
    pose: Vector,
    view: Vector,
    step: Vector,
    moving: int,
    low: int,
    high: int,
    stop: int,
) -> tuple[float, float, int]:
    """`tritree` over one angle of the posed body, compiled: matches of limbs over a drawn rest.

    Args:
        seen: The silhouette, packed (H, words).
        seen_px: Its number of pixels.
        width: Width of the picture, pixels.
        body: Body vector.
        pose: The 25 motion parameters; not changed.
        view: View vector of the kernel.
        step: (25,): the angle sets the pose to pose * (step == 0) + angle * step, so that one
            search can couple joints (knee = -2 hip, P34).
        moving: Limbs that move, as bits; the rest is drawn once.
        low: Bounds of the window, whole degrees; `high` likewise.
        stop: Width at which to stop.

    Returns:
        (angle, score of the whole model there, matches).
    """
    height = seen.shape[0]
    frames = np.empty((10, FRAME))
    place_limbs(body, pose, ALL_LIMBS, frames)
    rest = np.zeros_like(seen)
    draw_placed(frames, body, view, ALL_LIMBS & ~moving, width, rest)
    rest_px, rest_hit = count(rest), count_both(rest, seen)
    scratch, posed = rest.copy(), pose.copy()
    first, last, p = np.empty(height, np.int32), np.empty(height, np.int32), np.empty(PRIMITIVE)
    tree = begun(low, high)
    which = probe(tree, stop)
    while which >= 0:
        angle = angle_of(tree, which)
        for k in range(posed.size):
            if step[k] != 0.0:
                posed[k] = angle * step[k]
        hang_limbs(body, posed, moving, frames)
        drawn, hit = added(frames, body, view, moving, width, rest, seen, scratch, first, last, p)
        tell(tree, which, score(rest_hit + hit, rest_px + drawn, seen_px))
        which = probe(tree, stop)
    return tree[BEST_ANGLE], tree[BEST_SCORE], int(tree[MATCHES])
