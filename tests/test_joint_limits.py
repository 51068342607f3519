"""Poses held within the limits of joints, against limits and laws (P30, P35, T22)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from common.body.body import (
    ANGLE_NAMES,
    ANGLES_IN_POSE,
    ELBOW,
    HIP,
    KNEE,
    LIMITS_DEG,
    POSE_INDEX,
    SHOULDER,
    Vector,
    rest_pose,
)
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from integrator.pose.inverse_kinematics import HIGH_DEG, LOW_DEG
from integrator.pose.joint_limits import (
    OFF,
    TWIST_DEG,
    _along,
    _nearest,
    clipped,
    held,
    within,
)

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


def lower_limb(pose: Vector, at: int, at_bend: int) -> np.ndarray:
    """Where a lower limb points in the trunk's axes: R_z R_x R_y R_x(bend) of the upward axis."""
    x, y, z = pose[at : at + 3]
    upper = Rotation.from_euler("ZXY", [z, x, y], degrees=True)
    bend = Rotation.from_euler("X", pose[at_bend], degrees=True)
    return np.asarray((upper * bend).apply([0.0, 1.0, 0.0]))


@given(st.tuples(*[st.floats(-200.0, 200.0)] * 4))
@settings(max_examples=60, deadline=None)
def test_a_lower_limb_points_where_its_four_turns_lead(turns_deg: tuple[float, ...]) -> None:
    pose = rest_pose()
    pose[[SHOULDER, SHOULDER + 1, SHOULDER + 2, ELBOW]] = turns_deg
    assert _along(*turns_deg) == pytest.approx(lower_limb(pose, SHOULDER, ELBOW), abs=1e-12)


@given(st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_the_nearest_angles_within_the_limits_are_those_of_all_that_are_tried(seed: int) -> None:
    """theta_Z is turned to the axis or away from it, or to a limit; then theta_X as it may."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    before = rest_pose() + rng.uniform(-90.0, 90.0, 25)
    at = (SHOULDER, SHOULDER + 3, HIP, HIP + 3)[seed % 4]

    def into(deg: float, of: int) -> float:
        low, high = LOW_DEG[of], HIGH_DEG[of]
        same = [deg + 360.0 * turn for turn in range(-3, 4)]
        return float(np.clip(min(same, key=lambda each: abs(each - (low + high) / 2)), low, high))

    def off(one: float, other: float) -> float:
        return abs((one - other + 180.0) % 360.0 - 180.0)

    tried = []
    for half in (0.0, 180.0):
        z = into(np.degrees(np.arctan2(-axis[0], axis[1])) + half, at + 2)
        up, front = Rotation.from_euler("Z", -z, degrees=True).apply(axis)[1:]
        x = into(np.degrees(np.arctan2(front, up)), at)
        came = Rotation.from_euler("ZX", [z, x], degrees=True).apply([0.0, 1.0, 0.0])
        off_deg = np.degrees(np.arccos(np.clip(came @ axis, -1.0, 1.0)))
        tried.append((OFF * off_deg + off(x, before[at]) + off(z, before[at + 2]), x, z))
    _, x, z = min(tried)
    assert _nearest(axis, at, before) == pytest.approx((x, z), abs=1e-6)


def test_a_pose_is_held_near_the_one_before_and_not_the_other_way_round() -> None:
    """An arm straight up may be written as 180 or -180 about X; before, it was at 150."""
    pose, before = posed(r_shoulder_z=186.0), posed(r_shoulder_x=20.0)
    kept, moved = within(BODY, pose, before, joints(BODY, pose))
    assert np.array_equal(kept, held(pose, before))
    assert not np.array_equal(kept, before)
    assert moved == pytest.approx(joints(BODY, kept), abs=1e-9)


def test_a_knee_that_points_too_far_aside_is_turned_back_as_far_as_it_may() -> None:
    for aside_deg in (TWIST_DEG - 1.0, TWIST_DEG + 20.0, -TWIST_DEG - 20.0):
        pose = posed(r_hip_x=30.0, r_hip_y=aside_deg, r_knee_x=-40.0)
        found = held(pose, rest_pose())
        assert found[POSE_INDEX["r_hip_y"]] == pytest.approx(
            np.clip(aside_deg, -TWIST_DEG, TWIST_DEG)
        )
        front = lower_limb(pose, HIP, KNEE) @ lower_limb(found, HIP, KNEE)
        assert front > np.cos(np.radians(25.0))
