"""The way back from joints to angles, held against the way there."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from common.body.body import (
    ELBOW,
    HIP,
    JOINT_NAMES,
    KNEE,
    POSE_INDEX,
    SHOULDER,
    Vector,
    rest_pose,
)
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from integrator.pose.inverse_kinematics import (
    PLACES,
    STRAIGHT_DEG,
    _aim,
    bend,
    pose_of,
    trunk_of,
    turn_deg,
)
from integrator.proposal.network_weights import JOINTS
from integrator.proposal.pose_proposal import AT, pose_and_rest, trunk_axes

BODY = body_vector(thesis_bdp(1.75))


def posed(**angles_deg: float) -> Vector:
    pose = rest_pose()
    pose[:3] = 0.3, 0.9, -0.2
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


def twelve(pose: Vector) -> Vector:
    found: Vector = joints(BODY, pose)[AT]
    return found


def test_the_twelve_joints_stand_in_one_order_everywhere() -> None:
    assert tuple(PLACES) == JOINTS
    assert [JOINT_NAMES[i] for i in AT] == list(JOINTS)


@given(
    yaw=st.floats(-100.0, 100.0),
    bow=st.floats(-10.0, 40.0),
    roll=st.floats(-15.0, 15.0),
    arms=st.tuples(st.floats(70.0, 150.0), st.floats(210.0, 290.0)),
    swings=st.tuples(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0)),
    hip=st.floats(-20.0, 80.0),
)
@settings(max_examples=60, deadline=None)
def test_straight_limbs_come_back_as_they_were(
    yaw: float,
    bow: float,
    roll: float,
    arms: tuple[float, float],
    swings: tuple[float, float],
    hip: float,
) -> None:
    pose = posed(
        torso_y=yaw,
        torso_x=bow,
        torso_z=roll,
        r_shoulder_z=arms[0],
        l_shoulder_z=arms[1],
        r_shoulder_x=swings[0],
        l_shoulder_x=swings[1],
        r_hip_x=hip,
    )
    found = pose_of(twelve(pose), BODY, rest_pose())
    assert twelve(found) == pytest.approx(twelve(pose), abs=1e-6)
    for name in ("torso_x", "torso_y", "torso_z", "r_shoulder_z", "l_shoulder_x", "r_hip_x"):
        assert found[POSE_INDEX[name]] == pytest.approx(pose[POSE_INDEX[name]], abs=1e-3)


def test_bent_elbows_and_knees_put_the_hand_and_the_foot_back() -> None:
    """A cylinder bends beside its landmark, so the angle is found to a few degrees (E, W)."""
    pose = posed(r_elbow_x=70.0, l_elbow_x=40.0, r_hip_x=60.0, r_knee_x=-80.0, l_shoulder_z=250.0)
    found = pose_of(twelve(pose), BODY, rest_pose())
    assert np.linalg.norm(twelve(found) - twelve(pose), axis=1).max() < 0.03
    assert found[POSE_INDEX["r_elbow_x"]] == pytest.approx(70.0, abs=10.0)
    assert found[POSE_INDEX["r_knee_x"]] == pytest.approx(-80.0, abs=10.0)


def test_of_two_ways_to_one_place_the_nearer_is_taken() -> None:
    """theta_X 170 at theta_Z 180 is an arm raised forwards past the top, or 10 at 0."""
    raised = posed(r_shoulder_x=150.0)
    assert pose_of(twelve(raised), BODY, raised)[POSE_INDEX["r_shoulder_x"]] == pytest.approx(150.0)


def test_what_the_cylinders_cannot_show_is_kept_beside_them() -> None:
    """A raised shoulder: landmarks and the rest together are the joints that were found."""
    found = twelve(posed(torso_y=-30.0))
    found[:2, 1] += 0.03
    pose, rest = pose_and_rest(BODY, rest_pose(), found)
    assert joints(BODY, pose)[AT] + rest[AT] @ trunk_axes(BODY, pose).T == pytest.approx(found)
    assert np.abs(rest[AT[:2]]).max() > 0.005


def test_a_neck_does_not_rise_with_the_arms() -> None:
    """Raised arms lift both shoulders by a tenth of the spine; that keeps its length within 1 %."""
    neck, pelvis = (JOINT_NAMES.index(name) for name in ("neck", "pelvis"))
    lengths_m, shoulders_m = [], []
    for height, lift_m in (("hanging", -0.013), ("level", 0.03), ("up", 0.073)):
        turn_deg = {"hanging": 0.0, "level": 90.0, "up": 179.0}[height]
        found = twelve(posed(r_shoulder_x=turn_deg, l_shoulder_x=turn_deg, torso_y=-30.0))
        found[:6, 1] += lift_m
        pose, rest = pose_and_rest(BODY, rest_pose(), found)
        landmarks = joints(BODY, pose) + rest @ trunk_axes(BODY, pose).T
        lengths_m.append(np.linalg.norm(landmarks[neck] - landmarks[pelvis]))
        shoulders_m.append(landmarks[AT[:2], 1].mean() - landmarks[pelvis, 1])
    assert lengths_m == pytest.approx([lengths_m[0]] * 3, rel=0.01)
    assert shoulders_m[2] - shoulders_m[0] == pytest.approx(0.086, abs=0.002)


def test_a_neck_is_as_high_as_its_shoulders_say() -> None:
    """Of two people with hanging arms the one with shoulders 3 cm higher has such a neck."""
    neck = JOINT_NAMES.index("neck")
    heights_m = []
    for higher_m in (0.0, 0.03):
        found = twelve(posed())
        found[:6, 1] += higher_m
        pose, rest = pose_and_rest(BODY, rest_pose(), found)
        heights_m.append(joints(BODY, pose)[neck, 1] + rest[neck, 1])
    assert heights_m[1] - heights_m[0] == pytest.approx(0.03, abs=1e-3)


@pytest.mark.parametrize("bent_deg", [3.0, -3.0, STRAIGHT_DEG + 2.0, 60.0])
@pytest.mark.parametrize(("at", "at_bend"), [(SHOULDER, ELBOW), (HIP, KNEE)])
def test_a_limb_bends_its_own_way_alone(bent_deg: float, at: int, at_bend: int) -> None:
    """Elbows forwards and knees backwards; where one is nearly straight its twist stays, an elbow
    may be over-stretched a little, and a knee is straight at most."""
    pose = posed()
    pose[at : at + 3] = 20.0, 35.0, 170.0
    turned = bent_deg if at_bend == ELBOW else -bent_deg
    upper = Rotation.from_euler("ZXY", [170.0, 20.0, 35.0], degrees=True)
    lower = (upper * Rotation.from_euler("X", turned, degrees=True)).apply([0.0, 1.0, 0.0])
    assert turn_deg(lower, pose, at) == pytest.approx(turned)
    bend(pose, at, at_bend, lower)
    if abs(bent_deg) < STRAIGHT_DEG:
        assert pose[at + 1] == 35.0
        stays = turned if at_bend == ELBOW else min(0.0, turned)
        assert pose[at_bend] == pytest.approx(stays, abs=1e-6)
    else:
        assert pose[at + 1] == pytest.approx(35.0)
        assert pose[at_bend] == pytest.approx(turned)


def test_the_trunk_has_square_axes_to_the_left_up_and_ahead() -> None:
    joints_m = twelve(posed(torso_y=30.0, torso_x=10.0))
    axes = trunk_of(joints_m)
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert axes == pytest.approx(trunk_axes(BODY, posed(torso_y=30.0, torso_x=10.0)), abs=1e-6)


@pytest.mark.parametrize(("arm", "z_deg"), [("r_shoulder", 150.0), ("l_shoulder", 210.0)])
def test_of_two_ways_to_an_upper_arm_a_twist_before_does_not_decide(arm: str, z_deg: float) -> None:
    """By hand, of a right arm: x and z turn by 70 and 0 degrees, or by 50 and 180 past z's limit;
    the twist before is at the z of the second way."""
    other_deg = (z_deg + 180.0) % 360.0
    before = posed(**{f"{arm}_x": 100.0, f"{arm}_y": other_deg, f"{arm}_z": z_deg})
    x, z = np.radians([30.0, z_deg])
    axis = np.array([-np.cos(x) * np.sin(z), np.cos(x) * np.cos(z), np.sin(x)])
    found = _aim(axis, POSE_INDEX[f"{arm}_x"], before)
    assert found == pytest.approx((30.0, z_deg))
