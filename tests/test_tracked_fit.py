"""The search's starts, moves and bounds worked by hand, and what it makes of drawn bodies."""

import numpy as np
import pytest

from common.body.body import LIMBS, Vector
from common.body.stick_body import (
    ADULT,
    ANGLE,
    BREADTH,
    GIRTH,
    HEAD,
    RATIO,
    STATURE,
    TORSO,
    X,
    Y,
    standing,
)
from common.raster.bits import pack_words
from common.raster.similarity import Mask
from common.raster.stick_raster import draw_stick
from viewer.stick.normalization import NORMAL_SIZE
from viewer.stick.stick_costs import COSTS
from viewer.stick.tracked_fit import (
    _bounds,
    _lean_deg,
    _lying,
    _moves,
    _moving,
    _starts,
    _task,
    fit_tracked,
)

R_THIGH, L_THIGH, R_SHIN, L_SHIN, R_ARM, L_ARM, R_FOREARM, L_FOREARM = range(2, 10)
EVERYTHING = 0xFFF


def bits(*limbs: int) -> int:
    return sum(1 << limb for limb in limbs)


@pytest.mark.parametrize(
    ("numbers", "segments"),
    [
        ((X,), EVERYTHING),
        ((BREADTH,), EVERYTHING),
        ((GIRTH,), EVERYTHING),
        ((ANGLE + TORSO,), EVERYTHING),
        ((RATIO + TORSO,), EVERYTHING),
        ((ANGLE + HEAD,), bits(HEAD)),
        ((RATIO + HEAD,), bits(HEAD)),
        ((ANGLE + L_THIGH,), bits(L_THIGH, L_SHIN)),
        ((RATIO + R_ARM,), bits(R_ARM, R_FOREARM)),
        ((RATIO + L_FOREARM,), bits(L_FOREARM)),
        ((ANGLE + R_SHIN, ANGLE + HEAD), bits(R_SHIN, HEAD)),
    ],
)
def test_what_hangs_on_a_segment_moves_with_it(numbers: tuple[int, ...], segments: int) -> None:
    assert _moving(numbers) == segments


def test_moves_place_the_body_before_its_limbs() -> None:
    """Units: quarter pixels, degrees, fiftieths; limbs come leg by leg, then arm by arm."""
    moves = _moves()
    first = [int(np.flatnonzero(row)[0]) for row in moves.rows]
    assert len(first) == 30
    assert first[:9] == [X, Y, Y, ANGLE, RATIO, BREADTH, RATIO, STATURE, ANGLE + HEAD]
    assert moves.units[:9].tolist() == [0.25, 0.25, 0.25, 1.0, 0.02, 0.02, 0.02, 0.2, 1.0]
    legs_then_arms = [(2, 4), (3, 5), (6, 8), (7, 9)]
    for k, (upper, lower) in enumerate(legs_then_arms):
        own = moves.rows[9 + 5 * k : 14 + 5 * k]
        parts = [{int(n): float(row[n]) for n in np.flatnonzero(row)} for row in own]
        assert parts == [
            {ANGLE + upper: 1.0, ANGLE + lower: 1.0},
            {ANGLE + upper: 1.0},
            {ANGLE + lower: 1.0},
            {RATIO + upper: 1.0},
            {RATIO + lower: 1.0},
        ]
        assert moves.units[9 + 5 * k : 14 + 5 * k].tolist() == [1.0, 1.0, 1.0, 0.03, 0.03]
        assert moves.moving[9 + 5 * k : 14 + 5 * k].tolist() == [
            *([bits(upper, lower)] * 2),
            *(bits(lower), bits(upper, lower), bits(lower)),
        ]
    assert first[-1] == GIRTH
    assert moves.units[-1] == 0.02
    assert [int(n) for n in np.flatnonzero(moves.rows[6])] == [RATIO + TORSO, RATIO + HEAD]


def test_a_sinking_pelvis_leaves_neck_and_knees_where_they_are() -> None:
    """One pixel down: the trunk is a pixel longer, thighs that hang a pixel shorter."""
    down = _moves().rows[2]
    pose = standing(64.0, 80.0, 100.0)
    pose[[RATIO + TORSO, RATIO + R_THIGH, RATIO + L_THIGH]] = 0.8
    trunk_px, thigh_px = 100.0 * ADULT.lengths[TORSO], 100.0 * ADULT.lengths[R_THIGH]
    there = pose + 3.0 * down
    neck = [p[Y] - trunk_px * p[RATIO + TORSO] for p in (pose, there)]
    assert there[Y] == 83.0
    assert neck[1] == pytest.approx(neck[0])
    for limb in (R_THIGH, L_THIGH):
        knee = [p[Y] + thigh_px * p[RATIO + limb] for p in (pose, there)]
        assert knee[1] == pytest.approx(knee[0])
    assert np.flatnonzero(down).tolist() == [Y, RATIO + TORSO, RATIO + R_THIGH, RATIO + L_THIGH]


def test_numbers_of_a_pose_stay_in_their_ranges() -> None:
    lows, highs = _bounds()
    assert (lows[RATIO + R_SHIN], highs[RATIO + R_SHIN]) == (0.05, 1.0)
    assert [lows[RATIO + TORSO], lows[RATIO + HEAD], lows[RATIO + 9]] == [0.5, 0.5, 0.05]
    assert [lows[GIRTH], highs[GIRTH], lows[BREADTH], highs[BREADTH]] == [0.7, 1.5, 0.0, 1.0]
    for segment in (TORSO, HEAD):
        assert (lows[ANGLE + segment], highs[ANGLE + segment]) == (-30.0, 210.0)
    for free in (X, Y, STATURE, ANGLE + R_THIGH, ANGLE + L_FOREARM):
        assert (lows[free], highs[free]) == (-1e9, 1e9)


@pytest.mark.parametrize(
    ("angle_deg", "same_deg"),
    [(-90.0, -90.0), (-91.0, 269.0), (269.0, 269.0), (270.0, -90.0), (450.0, 90.0), (10.0, 10.0)],
)
def test_a_lean_is_counted_from_minus_ninety_degrees(angle_deg: float, same_deg: float) -> None:
    assert _lean_deg(angle_deg) == same_deg


def standing_mask() -> Mask:
    mask = np.zeros(NORMAL_SIZE[::-1], np.bool_)
    mask[20:117, 50:71] = True
    return mask


def test_a_standing_body_is_met_by_its_crown_and_by_its_soles_wide_and_thin() -> None:
    """By hand: the pelvis lies 0.465 statures of 100 px below row 20, or 0.535 above row 117."""
    starts = _starts(standing_mask())
    assert [start[BREADTH] for start in starts] == [1.0, 0.3, 1.0, 0.3]
    assert [start[Y] for start in starts] == pytest.approx([66.5, 66.5, 63.5, 63.5])
    assert {start[X] for start in starts} == {60.5}
    assert {start[STATURE] for start in starts} == {100.0}
    assert {start[ANGLE + TORSO] for start in starts} == {90.0}


@pytest.mark.parametrize("tilt_deg", [0.0, 20.0, -25.0])
def test_a_lying_body_is_met_with_its_crown_at_either_end(tilt_deg: float) -> None:
    """A bar of 90 by 20 px: the pelvis lies 46.5 px from either end, legs away from the crown."""
    rows, columns = np.indices((140, 160)) + 0.5
    right, up = columns - 82.0, 71.0 - rows
    turn = np.radians(tilt_deg)
    along = right * np.cos(turn) + up * np.sin(turn)
    across = up * np.cos(turn) - right * np.sin(turn)
    mask = (abs(along) < 45.0) & (abs(across) < 10.0)
    starts = sorted(_lying(mask), key=lambda start: start[ANGLE + TORSO])
    assert len(starts) == 2
    for start, crown_deg in zip(starts, (tilt_deg, tilt_deg + 180.0), strict=True):
        to = np.radians(crown_deg)
        reach = 45.0 - 46.5
        assert start[ANGLE + TORSO] == pytest.approx(crown_deg, abs=0.5)
        assert start[ANGLE + R_SHIN] - start[ANGLE + TORSO] == pytest.approx(180.0)
        assert start[X] == pytest.approx(82.0 + reach * np.cos(to), abs=3.6)
        assert start[Y] == pytest.approx(71.0 - reach * np.sin(to), abs=3.6)
        assert (start[BREADTH], start[STATURE]) == (0.3, 100.0)
    ends = np.array([start[[X, Y]] for start in starts])
    assert (ends.mean(axis=0)) == pytest.approx([82.0, 71.0], abs=0.4)


def test_the_pelvis_of_a_lying_body_is_measured_from_the_crown() -> None:
    """Level, 90 px long from column 30 to 120, 20 rows from 60 to 80: 46.5 px from either end
    (but for half a pixel: the crown is the middle of the last one)."""
    mask = np.zeros((140, 160), np.bool_)
    mask[60:80, 30:120] = True
    right, left = sorted(_lying(mask), key=lambda start: start[ANGLE + TORSO])
    assert [right[X], right[Y]] == pytest.approx([119.5 - 46.5, 70.0])
    assert [left[X], left[Y]] == pytest.approx([30.5 + 46.5, 70.0])
    assert len(_starts(mask)) == 6


def test_what_is_as_tall_as_broad_does_not_lie() -> None:
    square = np.zeros((100, 100), np.bool_)
    square[20:61, 30:71] = True
    assert _lying(square) == []
    square[20, 71] = True
    assert len(_lying(square)) == 2


def test_a_task_expects_the_normalised_stature_and_counts_leans_alike() -> None:
    mask, expected = standing_mask(), standing(64.0, 70.0, 137.0)
    expected[[ANGLE + TORSO, ANGLE + HEAD, ANGLE + L_ARM]] = 450.0, 300.0, 300.0
    task = _task(pack_words(mask), mask, expected, 0.7)
    assert task.expected[STATURE] == 100.0
    assert task.expected[[ANGLE, ANGLE + HEAD, ANGLE + L_ARM]].tolist() == [90.0, -60.0, 300.0]
    assert expected[STATURE] == 137.0
    assert expected[ANGLE + TORSO] == 450.0
    assert (task.seen_px, task.width, task.trust) == (97 * 21, NORMAL_SIZE[0], 0.7)
    assert task.costs is COSTS


def body(**turned_deg: float) -> Vector:
    pose = standing(62.0, 75.0, 100.0)
    for name, angle_deg in turned_deg.items():
        pose[ANGLE + LIMBS.index(name)] = angle_deg
    return pose


def test_what_fits_the_pose_before_is_not_looked_for_afresh() -> None:
    """One search from a pose that fits, five where it is worth less than 0.6, four at the start."""
    pose = body(r_upper_arm=200.0, r_lower_arm=190.0, l_upper_leg=290.0)
    mask = draw_stick(ADULT, pose, NORMAL_SIZE)
    near, first = fit_tracked(mask, pose), fit_tracked(mask, None)
    assert near.pose[ANGLE : ANGLE + 10] == pytest.approx(pose[ANGLE : ANGLE + 10], abs=2.0)
    assert 3.5 * near.evaluations < first.evaluations < 4.5 * near.evaluations
    lost = pose.copy()
    lost[X] += 60.0
    again = fit_tracked(mask, lost)
    assert again.pose[X] == pytest.approx(62.0, abs=1.5)
    assert again.evaluations > first.evaluations
    assert again.pose == pytest.approx(first.pose)


def test_a_limb_is_hidden_where_most_of_it_lies_over_the_body() -> None:
    pose = body(l_upper_arm=250.0, l_lower_arm=200.0, r_upper_arm=200.0, r_lower_arm=190.0)
    hidden = fit_tracked(draw_stick(ADULT, pose, NORMAL_SIZE), pose).hidden
    assert hidden.tolist() == [
        i == L_FOREARM or (i == L_ARM and bool(hidden[i])) for i in range(10)
    ]
    assert hidden[L_FOREARM]
    assert not hidden[[TORSO, HEAD, R_ARM, R_FOREARM]].any()
