"""What a stick pose costs, one cost at a time, worked by hand."""

import math

import numpy as np
import pytest

from common.body.body import Vector
from common.body.stick_body import ANGLE, BREADTH, GIRTH, HEAD, RATIO, STATURE, TORSO, standing
from viewer.stick.stick_costs import (
    ARM_TILT,
    BEND,
    BREADTH_CHANGE,
    COSTS,
    CROSS,
    GIRTH_CHANGE,
    LEAN,
    LEG_TILT,
    STATURE_CHANGE,
    STIFF_NECK,
    TILTED,
    TIME,
    TRUNK_TILT,
    bend_cost,
    cross_cost,
    limb_cost,
    pose_cost,
)

R_THIGH, L_THIGH, R_SHIN, L_SHIN, R_ARM, L_ARM, R_FOREARM, L_FOREARM = range(2, 10)
TRUST = 0.3
NO_ENDS = np.zeros((12, 4))


def only(which: int, value: float) -> Vector:
    """Costs of which one alone is anything."""
    costs = np.zeros(10)
    costs[which] = value
    return costs


def upright() -> Vector:
    return standing(64.0, 70.0, 100.0)


def cost_of(pose: Vector, costs: Vector, ends: Vector = NO_ENDS) -> float:
    return float(pose_cost(pose, ends, upright(), TRUST, costs))


def test_a_limb_costs_how_far_its_vector_turned_in_space() -> None:
    """(0.6 cos 30 - 0.8 cos 90, 0.6 sin 30 - 0.8 sin 90, a half of 0.8 - 0.6), squared."""
    pose, expected = upright(), upright()
    pose[[ANGLE + R_SHIN, RATIO + R_SHIN]] = 30.0, 0.6
    expected[[ANGLE + R_SHIN, RATIO + R_SHIN]] = 90.0, 0.8
    squares = 0.27 + 0.25 + 0.25 * 0.04
    found = limb_cost(pose, expected, R_SHIN, TRUST, only(TIME, 2.0))
    assert found == pytest.approx(TRUST * 2.0 * squares)
    assert limb_cost(pose, expected, L_SHIN, TRUST, only(TIME, 2.0)) == 0.0


def test_a_swing_by_sixty_degrees_costs_as_much_as_its_name_says() -> None:
    pose = upright()
    pose[ANGLE + L_ARM] += 60.0
    assert limb_cost(pose, upright(), L_ARM, 1.0, COSTS) == pytest.approx(0.006)


@pytest.mark.parametrize(
    ("limb", "which"),
    [(TORSO, TRUNK_TILT), (HEAD, LEG_TILT), (L_SHIN, LEG_TILT), (R_ARM, ARM_TILT)],
)
def test_a_limb_that_leaves_the_plane_costs_the_tilt_of_its_kind(limb: int, which: int) -> None:
    """0.64 / (0.64 + 0.15) of the full cost at a ratio of 0.6."""
    pose = upright()
    pose[RATIO + limb] = 0.6
    costs = np.array([0.0, 3.0, 5.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    full = limb_cost(pose, upright(), limb, TRUST, costs)
    assert full == pytest.approx(costs[which] * 0.64 / 0.79)


def test_half_the_tilt_is_at_twenty_three_degrees() -> None:
    pose = upright()
    pose[RATIO + R_ARM] = math.cos(math.radians(math.degrees(math.asin(math.sqrt(TILTED)))))
    assert math.degrees(math.asin(math.sqrt(TILTED))) == pytest.approx(22.8, abs=0.1)
    assert limb_cost(pose, pose, R_ARM, 1.0, only(ARM_TILT, 4.0)) == pytest.approx(2.0)


@pytest.mark.parametrize(("upper", "share"), [(R_THIGH, 0.4), (L_THIGH, 0.4), (R_ARM, 1), (7, 1)])
def test_a_bend_costs_as_far_as_both_limbs_lie_in_the_plane(upper: int, share: float) -> None:
    """1 - cos 60 is a half; knees count by the breadth that the trunk shows."""
    pose = upright()
    pose[BREADTH] = 0.4
    pose[[ANGLE + upper, ANGLE + upper + 2]] = 200.0, 260.0
    pose[[RATIO + upper, RATIO + upper + 2]] = 0.5, 0.8
    found = bend_cost(pose, upper, only(BEND, 3.0))
    assert found == pytest.approx(3.0 * 0.5 * 0.8 * 0.5 * share)


def test_an_elbow_bent_by_ninety_degrees_costs_as_much_as_its_name_says() -> None:
    pose = upright()
    pose[ANGLE + L_FOREARM] += 90.0
    assert bend_cost(pose, L_ARM, COSTS) == pytest.approx(0.012)


def crossed_ends(knees: tuple[float, float], feet: tuple[float, float]) -> Vector:
    """Far ends of thighs and shins in these columns, r before l."""
    ends = np.full((12, 4), 1000.0)
    ends[[R_THIGH, L_THIGH], 2] = knees
    ends[[R_SHIN, L_SHIN], 2] = feet
    return ends


@pytest.mark.parametrize(
    ("knees", "feet", "wrong_px"),
    [((57.0, 50.0), (40.0, 60.0), 7.0), ((50.0, 57.0), (63.0, 60.0), 3.0)],
    ids=["knees", "feet"],
)
def test_knees_and_feet_cost_what_they_cross(
    knees: tuple[float, float], feet: tuple[float, float], wrong_px: float
) -> None:
    """r is on the left of the picture: columns of r beyond those of l, in statures."""
    pose = upright()
    pose[[BREADTH, STATURE]] = 0.4, 80.0
    ends = crossed_ends(knees, feet)
    assert cross_cost(ends, pose, only(CROSS, 5.0)) == pytest.approx(5.0 * 0.4 * wrong_px / 80.0)
    ends = crossed_ends((57.0, 50.0), (63.0, 60.0))
    assert cross_cost(ends, pose, only(CROSS, 5.0)) == pytest.approx(5.0 * 0.4 * 10.0 / 80.0)


@pytest.mark.parametrize(
    ("at", "by", "which", "cost"),
    [
        (BREADTH, -0.3, BREADTH_CHANGE, 0.09),
        (STATURE, 20.0, STATURE_CHANGE, 0.04),
        (STATURE, -20.0, STATURE_CHANGE, 0.04),
        (GIRTH, 0.2, GIRTH_CHANGE, TRUST * 0.04),
        (ANGLE + TORSO, -30.0, LEAN, 0.25),
        (ANGLE + HEAD, 60.0, BEND, STIFF_NECK * 0.5),
        (ANGLE + TORSO, 60.0, BEND, STIFF_NECK * 0.5),
        (ANGLE + R_SHIN, 60.0, BEND, 0.5),
        (ANGLE + L_SHIN, -60.0, BEND, 0.5),
        (ANGLE + R_FOREARM, 60.0, BEND, 0.5),
        (ANGLE + L_FOREARM, 90.0, BEND, 1.0),
        (ANGLE + L_FOREARM, 60.0, TIME, TRUST),
        (ANGLE + TORSO, 60.0, TIME, TRUST),
        (ANGLE + HEAD, -60.0, TIME, TRUST),
        (RATIO + TORSO, -0.4, TRUNK_TILT, 0.64 / 0.79),
        (RATIO + L_FOREARM, -0.4, ARM_TILT, 0.64 / 0.79),
    ],
)
def test_a_pose_costs_what_left_the_expected_one(
    at: int, by: float, which: int, cost: float
) -> None:
    """One number of a standing pose is changed; the sign of a cost that is taken off S counts."""
    pose = upright()
    pose[at] += by
    assert cost_of(pose, only(which, 7.0)) == pytest.approx(7.0 * cost)
    assert cost_of(upright(), only(which, 7.0)) == pytest.approx(0.0, abs=1e-12)


def test_crossed_legs_count_in_the_cost_of_a_pose() -> None:
    ends = crossed_ends((57.0, 50.0), (40.0, 60.0))
    assert cost_of(upright(), only(CROSS, 5.0), ends) == pytest.approx(5.0 * 7.0 / 100.0)


def test_costs_of_a_pose_add_up() -> None:
    pose = upright()
    pose[[BREADTH, STATURE, GIRTH]] = 0.5, 110.0, 1.3
    pose[[ANGLE + TORSO, ANGLE + HEAD]] = 60.0, 120.0
    parts = sum(cost_of(pose, only(which, cost)) for which, cost in enumerate(COSTS))
    assert cost_of(pose, COSTS) == pytest.approx(parts)
    assert cost_of(pose, COSTS) > 0.2 * 0.25 + 10.0 * 0.01 + 0.01 * 0.25
