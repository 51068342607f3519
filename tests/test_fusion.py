"""Who is believed about what, held against the printed rules (section 4.4)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import posed
from staging import observation

from common.body.body import POSE_INDEX, POSE_NAMES, Vector
from common.body.observation import Observation
from common.method import DEFAULT, PAPER, Method
from integrator.paper.fusion import fused, lifted

FACADE = {
    "r_shoulder_y": -90.0,
    "r_shoulder_z": 101.0,
    "l_shoulder_y": 90.0,
    "l_shoulder_z": 201.0,
    "r_elbow_x": 11.0,
    "l_elbow_x": 12.0,
    "r_hip_z": 160.0,
    "l_hip_z": 205.0,
    "r_hip_x": 31.0,
    "l_hip_x": 32.0,
    "r_knee_x": -62.0,
    "l_knee_x": -64.0,
}
FLANK = {
    "r_shoulder_x": 71.0,
    "l_shoulder_x": 72.0,
    "r_hip_x": 81.0,
    "l_hip_x": 82.0,
    "r_knee_x": -83.0,
    "l_knee_x": -84.0,
}
BEFORE = np.arange(25.0) + 300.0


def facade(squatting: bool = False, **angles_deg: float) -> Observation:
    return observation(angles_deg=FACADE | angles_deg, squatting=squatting)


def flank() -> Observation:
    return observation(angles_deg=FLANK)


def of(pose: Vector, *names: str) -> list[float]:
    return [float(pose[POSE_INDEX[name]]) for name in names]


@pytest.mark.parametrize(
    ("hip_z_deg", "is_lifted", "though_squatting"),
    [
        (174.9, False, False),
        (175.0, True, False),
        (175.1, True, True),
        (178.0, True, True),
        (179.9, True, True),
        (180.0, True, False),
        (182.0, True, False),
        (185.0, True, False),
        (185.1, False, False),
        (160.0, False, False),
        (-180.0, True, False),
        (538.0, True, True),
    ],
)
def test_a_leg_is_lifted_within_five_degrees_of_hanging_or_as_printed_in_a_squat(
    hip_z_deg: float, is_lifted: bool, though_squatting: bool
) -> None:
    """P53, P54: 175 < theta_Z < 180 in print, the left mirrored. M16 adds 180 itself, where a leg
    rests, and the other side, but not for knees that squat."""
    for side, z_deg in (("r", hip_z_deg), ("l", 360.0 - hip_z_deg)):
        assert lifted(side, z_deg, squats=False) == is_lifted
        assert lifted(side, z_deg, squats=True) == though_squatting


def test_arms_are_the_flanks_theta_x_and_the_facades_rest() -> None:
    """P51, M11: whichever viewer is which."""
    pose = fused(BEFORE, facade(), flank(), PAPER)
    for side in "rl":
        assert of(pose, f"{side}_shoulder_x") == [FLANK[f"{side}_shoulder_x"]]
        for name in (f"{side}_shoulder_y", f"{side}_shoulder_z", f"{side}_elbow_x"):
            assert of(pose, name) == [FACADE[name]]


@pytest.mark.parametrize("squatting", [False, True], ids=["not squatting", "squatting"])
@pytest.mark.parametrize("method", [PAPER, DEFAULT], ids=["paper", "default"])
@pytest.mark.parametrize("right_deg", [178.0, 160.0], ids=["right lifted", "right not"])
@pytest.mark.parametrize("left_deg", [183.0, 205.0], ids=["left lifted", "left not"])
def test_legs_are_the_flanks_where_lifted_else_the_facades(
    squatting: bool, method: Method, right_deg: float, left_deg: float
) -> None:
    """P52, P53, P54: the truth table; each leg for itself.

    As printed a leg within the range is the flank's, also one that squats. Beyond the print a squat
    is asked for first.
    """
    seen = facade(squatting, r_hip_z=right_deg, l_hip_z=left_deg)
    pose = fused(BEFORE, seen, flank(), method)
    for side, hip_z_deg in (("r", right_deg), ("l", left_deg)):
        names = [f"{side}_hip_x", f"{side}_knee_x"]
        from_flank, from_facade = ([view[name] for name in names] for view in (FLANK, FACADE))
        unlifted = from_facade if squatting else [0.0, 0.0]
        may_lift = lifted(side, hip_z_deg, squatting) and not (squatting and method.squat_first)
        assert of(pose, *names) == (from_flank if may_lift else unlifted)
        assert of(pose, f"{side}_hip_z") == [hip_z_deg]


def test_without_the_facade_the_flank_tells_arms_and_legs() -> None:
    """P51, P52: what it cannot see stays."""
    pose = fused(BEFORE, None, flank(), PAPER)
    for name in POSE_NAMES:
        assert of(pose, name) == [FLANK.get(name, float(BEFORE[POSE_INDEX[name]]))]


@pytest.mark.parametrize("squatting", [False, True])
def test_without_the_flank_the_facade_tells_what_it_sees(squatting: bool) -> None:
    pose = fused(BEFORE, facade(squatting), None, PAPER)
    assert of(pose, "r_shoulder_x") == of(BEFORE, "r_shoulder_x")
    assert of(pose, "r_shoulder_z") == [FACADE["r_shoulder_z"]]
    assert of(pose, "r_hip_x") == [FACADE["r_hip_x"] if squatting else 0.0]


@given(st.booleans(), st.booleans())
def test_position_trunk_and_neck_are_nobodys_business_here(has_front: bool, has_side: bool) -> None:
    """P22: and what came in is left as it was."""
    before = BEFORE.copy()
    pose = fused(before, facade() if has_front else None, flank() if has_side else None, PAPER)
    assert (pose[:9] == BEFORE[:9]).all()
    assert (before == BEFORE).all()
    if not (has_front or has_side):
        assert (pose == BEFORE).all()


def test_resting_legs_are_not_squatting_ones() -> None:
    """P33: not squatting, theta_X of a leg that is not lifted is 0."""
    pose = fused(posed(r_hip_x=40.0, r_knee_x=-80.0), facade(), flank(), PAPER)
    assert of(pose, "r_hip_x", "r_knee_x") == [0.0, 0.0]
