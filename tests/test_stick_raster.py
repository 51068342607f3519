"""The drawn stick body, held against its definition and against what it is scored by."""

import numpy as np
import pytest
from stick_posing import SIZE, drawn, stick_pose

from common.body.stick_body import ADULT, ANGLE, THESIS, place_segments, standing
from common.raster.bits import pack_words
from common.raster.similarity import similarity
from common.raster.stick_raster import (
    ALL_SEGMENTS,
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
