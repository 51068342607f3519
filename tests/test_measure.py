"""The opening posture read off drawn figures, held against table 1's makers (section 2.4)."""

import math
import re

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import BODY, ROOT_PX, box_around, picture, posed, stretched

from common.body.body import LIMBS, Bdp, Elliptic, Vector
from common.body.kinematics import segments
from common.body.proportions import body_vector, thesis_bdp
from common.raster.similarity import Mask, similarity
from viewer.paper.fine_tuning import fine_tuned
from viewer.paper.measure import (
    arm_angle_deg,
    facade_shape,
    measure_front,
    measure_side,
    projection_width,
    refusal_of,
    without_head,
)

BDP = thesis_bdp(100.0)
TRUNK_PX = 2 * BDP.torso.long_radius
SHOULDER_ROW = ROOT_PX[1] - BDP.torso.height
"""Row of the trunk's upper end in `picture`."""


def opening(**angles_deg: float) -> Mask:
    return picture(stretched(**angles_deg))


def reference_width(mask: Mask) -> tuple[float, float, list[float]]:
    """x1, x2 and P(x), column by column as section 2.4 has it."""
    height, width = mask.shape
    projection = [0.0] * width
    for x in range(width):
        for y in range(height):
            if mask[y, x]:
                projection[x] += 1.0
    left = next(x for x in range(width) if projection[x] > 0)
    right = next(x for x in reversed(range(width)) if projection[x] > 0)
    average = sum(projection[left : right + 1]) / (right - left + 1)
    x1 = next(x for x in range(width) if projection[x] > average)
    x2 = next(x for x in reversed(range(width)) if projection[x] > average)
    return float(x1), float(x2), projection


@given(st.integers(0, 2**32 - 1), st.integers(3, 40), st.integers(3, 40))
def test_the_projection_is_the_references(seed: int, width: int, height: int) -> None:
    """P12, P13: the mean runs over the columns from the leftmost to the rightmost."""
    random = np.random.default_rng(seed)
    mask = random.random((height, width)) < 0.8 * random.random(width)
    mask[:, 0], mask[:, width // 2] = False, True
    mask[0, 0] = True
    x1, x2, _ = reference_width(mask)
    assert projection_width(mask) == pytest.approx((x1, x2), abs=1e-9)


def test_columns_that_are_all_alike_are_the_trunk() -> None:
    """P13: where none is above the mean."""
    mask = np.zeros((20, 30), np.bool_)
    mask[4:15, 7:12] = True
    assert projection_width(mask) == (7.0, 11.0)


@pytest.mark.parametrize("legs_deg", [0.0, 4.0, 8.0])
def test_the_trunk_is_as_wide_as_it_was_drawn(legs_deg: float) -> None:
    """P13: within a pixel with closed feet, two with open ones: it is read above y_c.

    Over all columns legs at 8 degrees would make it 31 of 23 pixels.
    """
    mask = opening(r_hip_z=180.0 - legs_deg, l_hip_z=180.0 + legs_deg)
    found = facade_shape(mask, box_around(mask))
    assert abs(found.right - found.left - TRUNK_PX) <= (1.0 if legs_deg == 0 else 2.0)
    assert found.centre == pytest.approx(ROOT_PX[0], abs=0.5)
    measure = measure_front(mask, box_around(mask))
    assert measure.bdp_px is not None
    assert abs(2 * measure.bdp_px.torso.long_radius - TRUNK_PX) <= 2.0
    if legs_deg == 8.0:
        x1, x2 = projection_width(mask)
        assert x2 - x1 > TRUNK_PX + 5.0


def test_the_head_is_removed_and_legs_and_trunk_stay() -> None:
    """P14: closing then opening by 0.8 trunk widths, reflected at the border."""
    mask = opening(r_hip_z=172.0, l_hip_z=188.0)
    rest = without_head(mask, TRUNK_PX)
    top = int(np.flatnonzero(rest.any(axis=1))[0])
    assert abs(top - SHOULDER_ROW) <= 1.0
    assert not (mask & ~rest)[top:].any()


def test_raised_arms_hide_the_shoulders() -> None:
    """P10, P14: 30 degrees above the horizontal the row is read in the arms: so it is refused."""
    mask = opening(r_shoulder_z=60.0, l_shoulder_z=300.0)
    top = int(np.flatnonzero(without_head(mask, TRUNK_PX).any(axis=1))[0])
    assert SHOULDER_ROW - top > 5


def test_lengths_are_the_papers_shares() -> None:
    """P15, P16, M7, rows down: head = y_h - y_top, trunk to legs as 4 to 6, two halves."""
    mask = opening()
    box = box_around(mask)
    found = facade_shape(mask, box)
    below = box.bottom + 1 - found.shoulder_row
    assert found.head == found.shoulder_row - box.top
    assert found.torso == pytest.approx(0.4 * below)
    assert found.leg == pytest.approx(0.3 * below)
    assert found.head + found.torso + 2 * found.leg == pytest.approx(box.bottom + 1 - box.top)
    assert found.head == pytest.approx(BDP.head.height, abs=1.5)


def test_the_theses_shares_are_another_prior() -> None:
    """P16, T4: trunk 52, upper leg 46, lower leg 52 of 150: the centre is 8 px higher of 86."""
    below = 52 + 46 + 52
    mask = opening()
    found = facade_shape(mask, box_around(mask))
    assert found.torso - BDP.torso.height == pytest.approx((0.4 - 52 / below) * 86, abs=1.0)


def test_widths_are_the_papers_shares_of_the_trunk() -> None:
    """P17, M10: head 0.20 and 0.16, leg 0.20 and (for the printed 0.36) 0.18; LR = W / 2."""
    mask = opening()
    found = facade_shape(mask, box_around(mask))
    body = measure_front(mask, box_around(mask)).bdp_px
    assert body is not None
    width = found.right - found.left
    assert body.head == Elliptic(0.20 * width, 0.16 * width, found.head)
    for name in LIMBS[2:6]:
        assert getattr(body, name) == Elliptic(0.20 * width, 0.18 * width, found.leg)
    assert body.torso.height == found.torso


def test_arms_have_two_equal_halves() -> None:
    """M6, P19: th_a needs it; their sum is the shoulder's distance from the tip."""
    mask = opening()
    body = measure_front(mask, box_around(mask)).bdp_px
    assert body is not None
    for side in "rl":
        upper, lower = getattr(body, f"{side}_upper_arm"), getattr(body, f"{side}_lower_arm")
        assert upper == lower
    true = BDP.r_upper_arm.height + BDP.r_lower_arm.height + BDP.r_lower_arm.radius
    assert 2 * body.r_upper_arm.height == pytest.approx(true, abs=4.0)


def test_the_centre_and_the_shoulders_lie_where_they_were_drawn() -> None:
    """P17, P18, M7: y_c = y_h + torso; shoulders 0.45 LR below the trunk's end."""
    mask = opening()
    measure, found = measure_front(mask, box_around(mask)), facade_shape(mask, box_around(mask))
    assert measure.centre_px == (found.centre, found.shoulder_row + found.torso)
    radius = (found.right - found.left) / 2
    shoulder_row = found.shoulder_row + 0.45 * radius
    limbs = segments(100 * BODY, stretched())
    true_row = ROOT_PX[1] - limbs[LIMBS.index("r_upper_arm"), 0, 1]
    true_column = ROOT_PX[0] + limbs[LIMBS.index("r_upper_arm"), 0, 0]
    assert shoulder_row == pytest.approx(true_row, abs=1.5)
    assert found.centre - radius == pytest.approx(true_column, abs=1.5)


@pytest.mark.parametrize(
    ("dx", "dy", "right_deg"),
    [(-30.0, 0.0, 90.0), (-30.0, -30.0 / math.sqrt(3), 60.0), (-30.0, 30.0 / math.sqrt(3), 120.0)],
    ids=["level", "30 degrees up", "30 degrees down"],
)
def test_the_angle_of_an_arm_knows_its_quadrant(dx: float, dy: float, right_deg: float) -> None:
    """P19, C3: 90 for a T-pose, 60 and 120 for +-30 degrees; the left arm 360 less that."""
    assert arm_angle_deg("r", dx, dy) == pytest.approx(right_deg)
    assert arm_angle_deg("l", -dx, dy) == pytest.approx(360.0 - right_deg)


@pytest.mark.parametrize("drop_deg", [0.0, 8.0, 15.0])
def test_arms_of_the_opening_posture_are_read_within_two_degrees(drop_deg: float) -> None:
    """P19, P20."""
    mask = opening(r_shoulder_z=90.0 + drop_deg, l_shoulder_z=270.0 - drop_deg)
    angles = measure_front(mask, box_around(mask)).arms_z_deg
    assert angles == pytest.approx((90.0 + drop_deg, 270.0 - drop_deg), abs=2.5)


def drawn(body: Bdp, arms_z_deg: tuple[float, float], centre_px: tuple[float, float]) -> Mask:
    pose = stretched(r_shoulder_z=arms_z_deg[0], l_shoulder_z=arms_z_deg[1])
    return picture(pose, body=body_vector(body.scaled(0.01)), root_px=centre_px)


@pytest.mark.parametrize("wrong", [0.8, 1.0, 1.2])
def test_fine_tuning_never_scores_worse(wrong: float) -> None:
    """P20: S after is at least S before, and the trunk's radius comes back within a pixel."""
    mask = opening(r_shoulder_z=95.0)
    torso = msgspec.structs.replace(BDP.torso, long_radius=wrong * BDP.torso.long_radius)
    start = msgspec.structs.replace(BDP, torso=torso)
    angles = (92.0, 266.0)
    tuned, tuned_angles = fine_tuned(mask, start, ROOT_PX, angles)
    before = similarity(mask, drawn(start, angles, ROOT_PX))
    after = similarity(mask, drawn(tuned, tuned_angles, ROOT_PX))
    assert after >= before
    assert after > 0.8
    assert tuned.torso.long_radius == pytest.approx(BDP.torso.long_radius, abs=1.0)
    assert tuned_angles == pytest.approx((95.0, 270.0), abs=2.0)


def test_the_side_view_has_the_trunks_depth() -> None:
    """P21: within a pixel; the near arm points at the camera and lies inside the trunk."""
    mask = picture(stretched(), viewer=2)
    measure = measure_side(mask, box_around(mask))
    assert measure.bdp_px is None
    assert measure.depth_px == pytest.approx(BDP.torso.short_radius, abs=1.0)
    assert measure.height_px == pytest.approx(100.0, abs=2.0)


def cut_off_head(mask: Mask) -> Mask:
    cut = mask.copy()
    cut[: round(SHOULDER_ROW) + 1] = False
    return cut


def refusal(pose: Vector) -> str:
    mask = picture(pose)
    return refusal_of(mask, box_around(mask))


@pytest.mark.parametrize(
    ("pose", "reason"),
    [
        (posed(), "arms are not stretched"),
        (stretched(r_shoulder_z=60.0), "right arm is not level \\(\\d+ degrees"),
        (stretched(l_shoulder_z=230.0, r_shoulder_z=90.0), "left arm is not level"),
        (posed(r_shoulder_z=30.0, l_shoulder_z=330.0), "arms are not stretched"),
    ],
    ids=["hanging", "right arm up", "left arm down", "both up"],
)
def test_other_postures_are_refused_with_a_reason(pose: Vector, reason: str) -> None:
    """P10."""
    assert re.search(reason, refusal(pose))


def test_the_opening_posture_is_accepted_and_a_headless_one_is_not() -> None:
    """P10: arms level or up to 20 degrees below."""
    for drop_deg in (0.0, 10.0, 20.0):
        assert refusal(stretched(r_shoulder_z=90.0 + drop_deg, l_shoulder_z=270.0 - drop_deg)) == ""
    cut = cut_off_head(opening())
    assert "no head" in refusal_of(cut, box_around(cut))


def test_somebody_too_broad_to_be_one_person_upright_is_refused() -> None:
    """P10: a trunk 0.23 statures wide is a trunk, one of 0.45 is not."""
    torso = msgspec.structs.replace(BDP.torso, long_radius=22.0)
    broad = drawn(msgspec.structs.replace(BDP, torso=torso), (90.0, 270.0), ROOT_PX)
    assert "closed feet" in refusal_of(broad, box_around(broad))
