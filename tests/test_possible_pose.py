"""What no body does: a limb beyond its length, all of it above a jump."""

import numpy as np
import pytest
from staging import PERSON, squatting, standing

from common.body.body import JOINT_NAMES
from common.body.kinematics import joints
from common.body.proportions import body_vector, stature
from integrator.pose.possible_pose import (
    JUMP_M,
    LONGEST,
    has_possible_limbs,
    is_within_a_jump,
)

STATURE_M = stature(PERSON)
STANDS = np.asarray(joints(body_vector(PERSON), standing()))
SQUATS = np.asarray(joints(body_vector(PERSON), squatting(80.0)))


@pytest.mark.parametrize("joints_m", [STANDS, SQUATS], ids=["stands", "squats"])
def test_ordinary_poses_are_possible(joints_m: np.ndarray) -> None:
    assert has_possible_limbs(joints_m, STATURE_M)
    assert is_within_a_jump(joints_m)


@pytest.mark.parametrize("name", ["head_top", "l_wrist", "r_knee", "l_ankle"])
def test_a_limb_may_be_longer_than_usual_and_not_twice_as_long(name: str) -> None:
    end = JOINT_NAMES.index(name)
    start = {"head_top": "neck", "l_wrist": "l_elbow", "r_knee": "r_hip", "l_ankle": "l_knee"}
    joint_m = STANDS[JOINT_NAMES.index(start[name])]
    for factor in (0.3, 1.4, 2.2):
        longer = STANDS.copy()
        longer[end] = joint_m + factor * (STANDS[end] - joint_m)
        if name == "r_knee":  # the shank moves along
            longer[JOINT_NAMES.index("r_ankle")] += longer[end] - STANDS[end]
        assert has_possible_limbs(longer, STATURE_M) == (factor < LONGEST)


def test_the_same_limbs_are_too_long_for_a_person_of_half_the_stature() -> None:
    assert not has_possible_limbs(STANDS, STATURE_M / 2.0)


def test_narrow_or_broad_shoulders_say_nothing() -> None:
    broad = STANDS.copy()
    for side, sign in (("l", 1.0), ("r", -1.0)):
        for part in ("shoulder", "elbow", "wrist"):
            broad[JOINT_NAMES.index(f"{side}_{part}")] += (sign * 0.3, 0.0, 0.0)
    assert has_possible_limbs(broad, STATURE_M)


def test_a_jump_of_three_quarters_of_a_metre_takes_four_fifths_of_a_second() -> None:
    assert 2.0 * np.sqrt(2.0 * JUMP_M / 9.81) == pytest.approx(0.78, abs=0.01)
    lowest_m = float(STANDS[:, 1].min())
    assert is_within_a_jump(STANDS + np.array([0.0, JUMP_M - lowest_m - 0.01, 0.0]))
    assert not is_within_a_jump(STANDS + np.array([0.0, JUMP_M - lowest_m + 0.01, 0.0]))


def test_a_hand_on_the_floor_carries_a_body_whose_feet_are_high() -> None:
    upside_down = STANDS * np.array([1.0, -1.0, 1.0])
    assert is_within_a_jump(upside_down - np.array([0.0, upside_down[:, 1].min(), 0.0]))
