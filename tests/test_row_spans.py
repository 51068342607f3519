"""Row intervals of limbs, held bit by bit against two definitions of a limb and numpy's counts."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.body.body import Vector
from common.raster.bits import count, count_both, pack_words, unpack_words
from common.raster.row_spans import EDGE, draw, gain, inside, spans
from common.raster.similarity import Mask

sizes = st.tuples(st.integers(1, 130), st.integers(1, 70))
places = st.one_of(
    st.integers(-20, 140).map(float),
    st.integers(-40, 280).map(lambda halves: halves / 2),
    st.floats(-20.0, 140.0).map(lambda place: round(place, 3)),
)
radii = st.one_of(
    st.integers(0, 40).map(float),
    st.integers(0, 60).map(lambda halves: halves / 2),
    st.floats(0.0, 40.0).map(lambda radius: round(radius, 3)),
)
shears = st.one_of(st.just(0.0), st.sampled_from([-1.0, -0.5, 0.5, 1.0]), st.floats(-2.0, 2.0))
stretches = st.one_of(st.just(1.0), st.sampled_from([0.25, 0.5, 2.0]), st.floats(0.05, 3.0))
limbs = st.builds(
    lambda *numbers: np.array(numbers), *[places, places, radii] * 2, shears, stretches
)


def rasterised(limb: Vector, size: tuple[int, int]) -> Mask:
    width, height = size
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    bits = np.zeros((height, (width + 63) // 64), np.uint64)
    top, bottom = spans(limb, width, height, first, last)
    draw(first, last, top, bottom, bits)
    return unpack_words(bits, width)


def pixel_by_pixel(limb: Vector, size: tuple[int, int]) -> Mask:
    width, height = size
    return np.array(
        [[inside(limb, x + 0.5, y + 0.5) for x in range(width)] for y in range(height)], np.bool_
    ).reshape(height, width)


def two_discs_and_what_lies_between(limb: Vector, size: tuple[int, int]) -> Mask:
    """Another definition: two discs, and the quadrangle of the points where tangents touch."""
    ax, ay, ra, bx, by, rb, shear, stretch = limb + np.array([0, 0, EDGE, 0, 0, EDGE, 0, 0])
    width, height = size
    y, x = np.mgrid[:height, :width] + 0.5
    x = (x - shear * y) / stretch
    covered = np.hypot(x - ax, y - ay) <= ra
    covered |= np.hypot(x - bx, y - by) <= rb
    length = math.hypot(bx - ax, by - ay)
    if length <= abs(ra - rb):
        return np.asarray(covered)
    along, lean = math.atan2(by - ay, bx - ax), math.acos((ra - rb) / length)
    corners = []
    for turn in (lean, -lean):
        nx, ny = math.cos(along + turn), math.sin(along + turn)
        ends = [(ax + ra * nx, ay + ra * ny), (bx + rb * nx, by + rb * ny)]
        corners += ends if turn > 0 else ends[::-1]
    sides = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    turning = sum(px * qy - qx * py for (px, py), (qx, qy) in sides)
    between = np.ones_like(covered)
    for (px, py), (qx, qy) in sides:
        off = (qx - px) * (y - py) - (qy - py) * (x - px)
        between &= math.copysign(1.0, turning) * off >= 0.0
    return np.asarray(covered | between)


SPECIAL = {
    "one disc": [20, 15, 5, 20, 15, 5, 0, 1],
    "disc on pixel centres": [20.5, 15.5, 5, 20.5, 15.5, 5, 0, 1],
    "a point on a pixel centre": [20.5, 15.5, 0, 20.5, 15.5, 0, 0, 1],
    "a line along pixel centres": [3.5, 7.5, 0, 40.5, 7.5, 0, 0, 1],
    "equal discs, level": [10, 15, 4, 50, 15, 4, 0, 1],
    "edges on pixel centres": [10, 15, 4.5, 50, 15, 4.5, 0, 1],
    "upright, edges on centres": [30, 10, 5.5, 30, 50, 5.5, 0, 1],
    "disc in a disc": [30, 30, 20, 33, 30, 5, 0, 1],
    "touching from within": [30, 30, 10, 35, 30, 5, 0, 1],
    "level, strongly tapered": [20, 30, 18, 45, 30, 2, 0, 1],
    "level, tapered, 3-4-5": [20.5, 30.5, 15, 45.5, 30.5, 0, 0, 1],
    "level, tapered the other way": [20, 30, 2, 45, 30, 18, 0, 1],
    "tapered slope": [10, 10, 12, 40, 22, 3, 0, 1],
    "sheared": [20, 15, 6, 35, 50, 3, 0.5, 1],
    "stretched": [10, 15, 8, 20, 50, 8, 0, 3],
    "sheared and flat": [100, 20, 3, 120, 50, 6, -1, 0.25],
    "beyond the left edge": [-30, 20, 9, -12, 40, 9, 0, 1],
    "across the whole picture": [-50, 20, 30, 200, 40, 30, 0, 1],
    "over two words": [60, 10, 3, 70, 12, 3, 0, 1],
}


@pytest.mark.parametrize("limb", SPECIAL.values(), ids=SPECIAL.keys())
def test_special_limbs_are_both_definitions(limb: list[float]) -> None:
    """P9: bit by bit, ties of a pixel's centre with the outline included."""
    drawn = rasterised(np.array(limb, float), (130, 70))
    assert (drawn == pixel_by_pixel(np.array(limb, float), (130, 70))).all()
    assert (drawn == two_discs_and_what_lies_between(np.array(limb, float), (130, 70))).all()


@settings(max_examples=60, deadline=None)
@given(limbs, sizes)
def test_any_limb_is_the_set_of_pixels_whose_centres_lie_in_it(
    limb: Vector, size: tuple[int, int]
) -> None:
    """P9: `inside`, pixel by pixel, at every size."""
    assert (rasterised(limb, size) == pixel_by_pixel(limb, size)).all()


@settings(max_examples=500, deadline=None)
@given(limbs, sizes)
def test_any_limb_is_two_discs_and_what_lies_between(limb: Vector, size: tuple[int, int]) -> None:
    """P9: the same bits from an independent definition."""
    assert (rasterised(limb, size) == two_discs_and_what_lies_between(limb, size)).all()


@settings(max_examples=150, deadline=None)
@given(st.lists(limbs, min_size=1, max_size=4), sizes, st.integers(0, 2**32 - 1))
def test_union_is_or_and_counting_is_popcount(
    several: list[Vector], size: tuple[int, int], seed: int
) -> None:
    """P9: what limbs add to a rest, counted from bits and by numpy."""
    width, height = size
    random = np.random.default_rng(seed)
    rest, seen = random.random((2, height, width)) < 0.4
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    bits, drawn, hit = pack_words(rest), 0, 0
    for limb in several:
        rows = spans(limb, width, height, first, last)
        more_drawn, more_hit = gain(first, last, *rows, bits, pack_words(seen))
        drawn, hit = drawn + more_drawn, hit + more_hit
        draw(first, last, *rows, bits)
    new = np.any([rasterised(limb, size) for limb in several], axis=0) & ~rest
    assert (drawn, hit) == (new.sum(), (new & seen).sum())
    assert (unpack_words(bits, width) == (new | rest)).all()
    assert count(pack_words(seen)) == seen.sum()
    assert count_both(pack_words(rest), pack_words(seen)) == (rest & seen).sum()
