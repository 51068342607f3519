"""The opening posture read off drawn figures, held against table 1's makers (section 2.4)."""

import math
import re

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import BODY, ROOT_PX, SIZE, box_around, picture, posed, stretched, view

from common.body.body import LIMBS, Bdp, Elliptic, Vector
from common.body.kinematics import segments
from common.body.observation import Observation
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import Guide
from common.raster.bits import count, pack_words, unpack_words
from common.raster.kernel import draw_limbs
from common.raster.silhouette_report import pack
from common.raster.similarity import Mask, similarity
from viewer.paper import fine_tuning
from viewer.paper.fine_tuning import ABOVE_CENTRE, _climbed, _score, _tuned, fine_tuned
from viewer.paper.measure import (
    FacadeShape,
    _arm_angles,
    _arm_lengths,
    _arm_thickness,
    arm_angle_deg,
    facade_shape,
    measure_front,
    measure_side,
    opening_measure,
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


def blocks(
    head_px: int = 10,
    trunk_px: int = 20,
    right_px: int = 40,
    left_px: int = 45,
    tip_row: int | None = None,
) -> Mask:
    """Rows 10 to 109: a head, a trunk around column 80, thin arms; a right tip that hangs."""
    mask = np.zeros((120, 160), np.bool_)
    begin, end = 80 - trunk_px // 2, 80 + (trunk_px + 1) // 2
    mask[10 : 10 + head_px, 77:83] = True
    mask[10 + head_px : 110, begin:end] = True
    mask[24:29, begin - right_px : begin] = True
    mask[27:34, end : end + left_px] = True
    if tip_row is not None:
        mask[24:29, begin - right_px : begin - right_px + 5] = False
        mask[tip_row : tip_row + 5, begin - right_px : begin - right_px + 5] = True
    return mask


def refused(mask: Mask) -> str:
    return refusal_of(mask, box_around(mask))


def test_a_body_of_blocks_is_read_as_worked_by_hand() -> None:
    """Shoulders at row 20, 90 px above the soles; arms from 4.5 px below them, to their tips."""
    mask = blocks()
    box = box_around(mask)
    found = facade_shape(mask, box)
    assert found == pytest.approx(FacadeShape(70.0, 90.0, 80.0, 20, 10, 36.0, 27.0))
    right, left = (-40.0, 26.5 - 24.5), (45.0, 30.5 - 24.5)
    assert _arm_lengths(mask, box, found) == pytest.approx((math.hypot(*right), math.hypot(*left)))
    angles = [math.degrees(math.atan2(abs(dx), -dy)) for dx, dy in (right, left)]
    assert _arm_angles(mask, box, found) == pytest.approx((angles[0], 360.0 - angles[1]))
    assert _arm_thickness(mask, found, box) == 7.0
    assert _arm_thickness(blocks(left_px=30), found, box_around(blocks(left_px=30))) == 5.0
    assert refused(mask) == ""


@pytest.mark.parametrize(
    ("mask", "reason"),
    [
        (blocks(right_px=20, left_px=29), "the arms are not stretched out to the sides"),
        (blocks(right_px=20, left_px=30), ""),
        (blocks(trunk_px=36), ""),
        (
            blocks(trunk_px=37),
            "the trunk seems 37% of the height wide: stand upright with closed feet",
        ),
        (blocks(trunk_px=12), ""),
        (
            blocks(trunk_px=11),
            "the trunk seems 11% of the height wide: stand upright with closed feet",
        ),
        (blocks(tip_row=40), ""),
        (blocks(tip_row=41), "the right arm is not level (25 degrees off)"),
        (blocks(tip_row=64), "the right arm is not level (46 degrees off)"),
    ],
)
def test_what_is_refused_says_by_how_much_and_on_which_side(mask: Mask, reason: str) -> None:
    """P10: both sides of each bound, in a body of 100 px."""
    assert refused(mask) == reason


def test_the_left_arm_is_refused_as_the_right_one() -> None:
    mask = blocks(tip_row=64)
    mirrored = mask[:, ::-1].copy()
    assert refused(mirrored) == "the left arm is not level (46 degrees off)"


@pytest.mark.parametrize(("head_px", "reason"), [(4, "no head above the shoulders"), (5, "")])
def test_a_head_is_a_twentieth_of_the_height_at_least(head_px: int, reason: str) -> None:
    assert refused(blocks(head_px=head_px)) == reason


@pytest.mark.parametrize(("head_px", "reason"), [(31, "no head above the shoulders"), (30, "")])
def test_a_head_is_no_more_than_three_tenths_of_the_height(head_px: int, reason: str) -> None:
    mask = blocks(head_px=head_px)
    mask[24:34, :70] = mask[24:34, 90:] = False
    low = 10 + head_px
    mask[low + 3 : low + 8, 30:70] = mask[low + 3 : low + 8, 90:130] = True
    assert refused(mask) == reason


def test_the_depth_is_read_above_the_centre_alone() -> None:
    """P21: rows 10 to 58 of 100 px, the trunk's columns 60 to 71; legs apart are far broader."""
    mask = np.zeros((120, 160), np.bool_)
    mask[10:60, 60:72] = True
    mask[60:110, 45:91] = True
    measure = measure_side(mask, box_around(mask))
    assert (measure.height_px, measure.centre_px, measure.depth_px) == (100.0, (66.0, 10.0), 6.0)


def seen_as(mask: Mask, cut: bool = False) -> Observation:
    box = box_around(mask)
    return Observation(
        width=160, height=120, silhouette=pack(mask), box=box, area_px=int(mask.sum()), cut=cut
    )


def test_a_view_measures_until_the_body_is_measured() -> None:
    """P10, P21: the facade its opening posture, the flank a depth; who is cut tells nothing."""
    mask = blocks()
    box = box_around(mask)
    guide = Guide(frame=0, captured_s=0.0, clock_s=0.0, frames=(0, 0), measured=True)
    unmeasured = msgspec.structs.replace(guide, measured=False)
    assert opening_measure(mask, seen_as(mask), guide, "facade") == (None, "")
    for known in (None, unmeasured):
        facade = opening_measure(mask, seen_as(mask), known, "facade")
        assert facade == (measure_front(mask, box), "")
        assert opening_measure(mask, seen_as(mask), known, "flank") == (
            measure_side(mask, box),
            "",
        )
    hanging = blocks(tip_row=64)
    assert opening_measure(hanging, seen_as(hanging), None, "facade") == (None, refused(hanging))
    outside = "the person is partly outside the picture"
    assert opening_measure(mask, seen_as(mask, cut=True), None, "flank") == (None, outside)


def test_fine_tuning_starts_from_what_was_read_and_reaches_as_far_as_it_may_be_wrong(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """P20: a quarter of the trunk's radius, the arms' own, a pixel of a tip, eight degrees."""
    got: list[tuple[list[float], list[float]]] = []

    def climbed(_score_of: object, values: list[float], spans: list[float]) -> list[float]:
        got.append((values, spans))
        return [11.0, 3.0, 42.0, 46.0, 93.0, 267.0]

    monkeypatch.setattr(fine_tuning, "_climbed", climbed)
    bdp = measure_front(blocks(), box_around(blocks())).bdp_px
    assert bdp is not None
    assert bdp.torso.long_radius == 11.0
    assert [bdp.r_upper_arm.height, bdp.l_upper_arm.height] == [21.0, 23.0]
    values, spans = got[0]
    assert values[:4] == pytest.approx([10.0, 3.5, math.hypot(40.0, 2.0), math.hypot(45.0, 6.0)])
    assert spans == [2.5, 3.5, 1.0, 1.0, 8.0, 8.0]
    thin = msgspec.structs.replace(BDP.torso, long_radius=3.0)
    fine_tuned(blocks(), msgspec.structs.replace(BDP, torso=thin), (80.0, 56.0), (90.0, 270.0))
    assert got[1][1][:2] == [1.0, max(1.0, BDP.r_upper_arm.radius)]


def test_a_climb_sets_each_value_in_turn_within_its_span() -> None:
    """By hand: eighths, spans of 2 and 4 about 5 and 9; a third value is moved by no score."""
    asked: list[list[float]] = []

    def score_of(values: list[float]) -> float:
        asked.append(values)
        return 5.0 - abs(values[0] - 6.25) - 0.1 * abs(values[1] - 20.0)

    found = _climbed(score_of, [5.0, 9.0, 2.0], [2.0, 4.0, 1.0])
    assert found == [pytest.approx(6.25, abs=0.25), pytest.approx(20.0, abs=0.5), 2.0]
    firsts = [values[0] for values in asked[1:10] if values[1:] == [9.0, 2.0]]
    assert (min(firsts), max(firsts)) == (3.0, 7.0)
    assert min(values[0] for values in asked) >= 1 / 8


def test_a_climb_ends_when_a_round_adds_little() -> None:
    """The first round finds the top, the second adds nothing; each costs what its trees cost."""
    asked: list[float] = []

    def score_of(values: list[float]) -> float:
        asked.append(values[0])
        return 1.0 - 0.01 * abs(values[0] - 5.0)

    assert _climbed(score_of, [5.0], [1.0]) == [5.0]
    assert len(asked) == 1 + 3 + 2 + 2


def test_a_value_is_never_tuned_below_an_eighth() -> None:
    asked: list[float] = []

    def score_of(values: list[float]) -> float:
        asked.append(values[0])
        return 5.0 - values[0]

    assert _climbed(score_of, [0.5], [1.0])[0] == 0.125
    assert min(asked) == 0.125


def test_the_score_of_fine_tuning_is_that_of_the_tuned_body_above_the_centre() -> None:
    """P20: trunk radius, arm radius, arms' lengths and angles, right before left."""
    mask = opening(r_shoulder_z=95.0, l_shoulder_z=262.0)
    mask[round(ROOT_PX[1]) :] = False
    bdp = BDP.scaled(0.01)
    values = [0.13, 0.03, 0.36, 0.30, 97.0, 258.0]
    body, pose = body_vector(_tuned(bdp, values)), stretched(r_shoulder_z=97.0, l_shoulder_z=258.0)
    bits = np.zeros_like(pack_words(mask))
    draw_limbs(body, pose, view(1), ABOVE_CENTRE, SIZE[0], bits)
    seen = pack_words(mask)
    found = _score(
        np.array(values), np.array(bdp.lengths()), stretched(), view(1), SIZE[0], seen, count(seen)
    )
    assert found == pytest.approx(similarity(mask, unpack_words(bits, SIZE[0])))
    assert 0.5 < found < 0.95
