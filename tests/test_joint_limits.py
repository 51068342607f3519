"""Poses held within the limits of joints, against limits and laws (P30, P35, T22)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, LIMITS_DEG, POSE_INDEX, Vector, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from integrator.pose.joint_limits import clipped, held, within

BODY = body_vector(thesis_bdp(1.75))
ANGLES = st.floats(-720.0, 720.0)


def posed(**angles_deg: float) -> Vector:
    pose = rest_pose()
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


@given(st.lists(ANGLES, min_size=len(ANGLE_NAMES), max_size=len(ANGLE_NAMES)))
@settings(max_examples=100, deadline=None)
def test_every_pose_is_held_within_every_limit(angles_deg: list[float]) -> None:
    pose = rest_pose()
    pose[list(ANGLES_IN_POSE)] = angles_deg
    found = held(pose, rest_pose())
    for angles in (found[list(ANGLES_IN_POSE)], clipped(np.array(angles_deg))):
        for name, angle_deg in zip(ANGLE_NAMES, angles, strict=True):
            low, high = LIMITS_DEG.get(name, (-1e9, 1e9))
            assert low - 1e-9 <= angle_deg <= high + 1e-9, name


def test_a_pose_within_the_limits_is_left_as_it_is() -> None:
    """A side kick, a squat, arms up and out."""
    pose = posed(r_hip_z=110.0, l_hip_x=80.0, l_knee_x=-120.0, r_shoulder_z=60.0, l_elbow_x=90.0)
    assert np.array_equal(held(pose, rest_pose()), pose)


@pytest.mark.parametrize("beyond_deg", [20.0, 40.0])
def test_an_arm_written_the_other_way_round_is_put_right_without_moving(beyond_deg: float) -> None:
    """Of a direction's two pairs of angles one is within the limits."""
    pose = posed(l_shoulder_x=180.0, l_shoulder_z=beyond_deg, l_shoulder_y=90.0)
    found = held(pose, pose)
    assert found[POSE_INDEX["l_shoulder_z"]] == pytest.approx(180.0 + beyond_deg)
    assert joints(BODY, found) == pytest.approx(joints(BODY, pose), abs=1e-9)


def test_an_arm_that_hangs_a_little_inwards_hangs_straight() -> None:
    pose = posed(r_shoulder_z=186.0)
    kept, moved = within(BODY, pose, rest_pose(), joints(BODY, pose))
    assert kept[POSE_INDEX["r_shoulder_z"]] == 180.0
    assert kept[POSE_INDEX["r_shoulder_x"]] == pytest.approx(0.0, abs=1e-9)
    assert moved == pytest.approx(joints(BODY, kept), abs=1e-9)


def test_a_knee_does_not_bend_to_the_front() -> None:
    """T22: knees bend backwards; a half turn of the thigh would let them do otherwise."""
    pose = posed(r_hip_y=180.0, r_knee_x=-60.0)
    found = held(pose, rest_pose())
    assert found[POSE_INDEX["r_knee_x"]] == pytest.approx(0.0, abs=25.0)
    assert joints(BODY, found)[-1, 2] < joints(BODY, pose)[-1, 2] - 0.15
