"""The drawn stick body, held against its definition and against what it is scored by."""

import math

import numpy as np
import pytest
from stick_posing import SIZE, drawn, stick_pose

from common.body.body import Vector
from common.body.stick_body import (
    ADULT,
    ANGLE,
    BREADTH,
    FLAT,
    FLAT_WIDE,
    GIRTH,
    ROUND,
    ROUND_WIDE,
    STATURE,
    THESIS,
    place_segments,
    standing,
)
from common.raster.bits import pack_words
from common.raster.similarity import similarity
from common.raster.stick_raster import (
    ALL_SEGMENTS,
    _primitive,
    added,
    draw_segments,
    draw_stick,
    match_stick,
    widening,
)


@pytest.mark.parametrize("angle_deg", [0.0, 20.0, 63.0, 90.0, 135.0, 270.0])
def test_a_thesis_cylinder_is_a_rectangle(angle_deg: float) -> None:
    """T4, T5, M18: 25 by 10 of 175, at every angle."""
    pose = standing(200.0, 360.0, 525.0)
    pose[ANGLE + 6] = angle_deg
    mask = draw_stick(THESIS, pose, (400, 400), 1 << 6)
    assert mask.sum() == pytest.approx(75 * 30, rel=0.04)
    rows, columns = np.nonzero(mask)
    spread = np.linalg.eigvalsh(np.cov(columns, rows))
    assert np.sqrt(12 * spread) == pytest.approx([30, 75], rel=0.04)


def test_the_compiled_score_is_the_plain_one() -> None:
    """Eq. 3.3."""
    seen, pose = drawn(stick_pose({"l_upper_arm": 340.0})), stick_pose({})
    plain = similarity(seen, drawn(pose))
    compiled = match_stick(
        ADULT.lengths, ADULT.parts, ADULT.depth, pose, ALL_SEGMENTS, SIZE[0], pack_words(seen)
    )
    assert compiled == pytest.approx(plain, abs=1e-12)


def test_what_limbs_add_is_what_drawing_them_adds() -> None:
    pose = stick_pose({"r_upper_arm": 200.0, "r_lower_arm": 300.0})
    seen = pack_words(drawn(stick_pose({})))
    ends, limbs = np.empty((12, 4)), 1 << 6 | 1 << 8
    place_segments(ADULT.lengths, pose, ends)
    rest = pack_words(draw_stick(ADULT, pose, SIZE, ALL_SEGMENTS & ~limbs))
    scratch, first, last = rest.copy(), np.empty(240, np.int32), np.empty(240, np.int32)
    more, hit = added(
        ends, pose, ADULT.parts, ADULT.depth, limbs, SIZE[0], rest, seen, scratch, first, last,
        np.empty(8),
    )  # fmt: skip
    new = drawn(pose) & ~draw_stick(ADULT, pose, SIZE, ALL_SEGMENTS & ~limbs)
    assert (more, hit) == (new.sum(), (new & drawn(stick_pose({}))).sum())
    assert np.array_equal(scratch, rest)


def test_a_trunk_seen_from_the_side_is_as_wide_as_it_is_deep() -> None:
    assert widening(1.0, 0.6) == pytest.approx(1.0)
    assert widening(0.0, 0.6) == pytest.approx(0.6)


def test_drawing_leaves_what_was_there() -> None:
    bits = pack_words(np.ones((240, 320), np.bool_))
    ends, pose = np.empty((12, 4)), stick_pose({})
    place_segments(ADULT.lengths, pose, ends)
    before = bits.copy()
    draw_segments(ends, pose, ADULT.parts, ADULT.depth, ALL_SEGMENTS, 320, bits)
    assert np.array_equal(bits, before)


def ends_of(part: list[float], breadth: float = 1.0) -> list[tuple[Vector, Vector]]:
    """Middle (px) and square of the half axes (px^2) of both ends of a drawn part: segment 3 goes
    from (10, 20) to (40, 60), segment 0 from (5, 9) to (5, 109) and segment 1 along a row.
    """
    ends, pose, p = np.zeros((12, 4)), np.zeros(25), np.empty(8)
    ends[3], ends[0], ends[1] = (10, 20, 40, 60), (5, 9, 5, 109), (5, 9, 85, 9)
    pose[[STATURE, BREADTH, GIRTH]] = 200.0, breadth, 1.5
    _primitive(ends, np.array(part), pose, widening(breadth, 0.6), p)
    shape = np.array([[p[7], p[6]], [0.0, 1.0]])
    return [(shape @ p[at : at + 2], p[at + 2] ** 2 * shape @ shape.T) for at in (0, 3)]


def test_a_round_part_of_a_limb_has_two_discs_at_its_shares_as_thick_as_its_clothes() -> None:
    """By hand: a tenth and nine tenths of the way; 200 px * 0.03 and 0.02, times 1.5."""
    (near, one), (far, other) = ends_of([3, 0.1, 0.9, 0.03, 0.02, ROUND])
    assert np.array([near, far]) == pytest.approx(np.array([[13.0, 24.0], [37.0, 56.0]]))
    assert np.array([one, other]) == pytest.approx(np.array([81.0 * np.eye(2), 36.0 * np.eye(2)]))


def test_a_flat_part_ends_in_lines_across_it() -> None:
    """3-4-5: a line of half length 9 px along (-0.8, 0.6), and one of 6."""
    (near, one), (far, other) = ends_of([3, 0.1, 0.9, 0.03, 0.02, FLAT])
    assert np.array([near, far]) == pytest.approx(np.array([[13.0, 24.0], [37.0, 56.0]]))
    for square, half_px in ((one, 9.0), (other, 6.0)):
        line = half_px**2 * np.outer([-0.8, 0.6], [-0.8, 0.6])
        assert square == pytest.approx(line, abs=2e-6 * half_px**2)


@pytest.mark.parametrize("breadth", [1.0, 0.25])
def test_the_trunk_narrows_as_it_turns_and_wears_no_sleeves(breadth: float) -> None:
    """Its line across lies level, and is a thousandth as thick; a narrow part does not turn."""
    wide = math.sqrt(breadth**2 + 0.36 * (1 - breadth**2))
    for kind, times in ((FLAT_WIDE, wide), (FLAT, 1.0), (ROUND_WIDE, wide), (ROUND, 1.0)):
        (near, square), (far, _) = ends_of([0, 0.06, 0.66, 0.09, 0.1, kind], breadth)
        assert np.array([near, far]) == pytest.approx(np.array([[5.0, 15.0], [5.0, 75.0]]))
        thick = 1.0 if kind in (ROUND, ROUND_WIDE) else 1e-3
        half_px = np.sqrt(np.diag(square))
        assert half_px == pytest.approx([18 * times, thick * 18 * times], rel=1e-3)


def test_a_flat_part_along_a_row_ends_in_upright_lines() -> None:
    (_, square), _ = ends_of([1, 0.0, 1.0, 0.05, 0.05, FLAT])
    assert np.sqrt(np.diag(square)) == pytest.approx([1e-2, 10.0], rel=1e-3)


def test_limbs_alone_wear_sleeves() -> None:
    """Trunk, head and the lines of shoulders and hips are as thick as the proportions say."""
    ends, pose, p = np.tile([10.0, 20.0, 40.0, 60.0], (12, 1)), np.zeros(25), np.empty(8)
    pose[[STATURE, BREADTH, GIRTH]] = 100.0, 1.0, 1.5
    radii = []
    for row in range(12):
        _primitive(ends, np.array([row, 0.0, 1.0, 0.04, 0.02, ROUND]), pose, 1.0, p)
        radii.append((round(p[2], 9), round(p[5], 9)))
    assert radii == [(4.0, 2.0)] * 2 + [(6.0, 3.0)] * 8 + [(4.0, 2.0)] * 2


def test_a_part_without_length_is_a_disc() -> None:
    ends, pose, p = np.full((12, 4), 7.0), np.zeros(25), np.empty(8)
    pose[[STATURE, GIRTH]] = 100.0, 1.0
    _primitive(ends, np.array([2, 0.0, 1.0, 0.04, 0.03, FLAT]), pose, 1.0, p)
    assert p.tolist() == [7.0, 7.0, 4.0, 7.0, 7.0, 3.0, 0.0, 1.0]
