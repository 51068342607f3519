"""Elbows and knees in files of motion are hinges: they bend about one axis of the upper limb."""

import re
from functools import partial

import numpy as np
import pytest
from moving import BODY, random_joints
from scipy.spatial.transform import Rotation
from test_bvh import read_bvh

from animator.bvh import bvh_text, euler_zxy_deg, steady
from animator.exchange.opensim_model import mot_text
from animator.skeleton.bone_turns import motion_of, turned_axes
from animator.skeleton.bones import BONES, Motion, joints_of, skeleton_of
from animator.skeleton.limb_twist import HINGES, STRAIGHT_DEG, Before, limb_twists
from common.body.body import POSE_INDEX, rest_pose
from common.body.kinematics import joints, limb_frames

NAMES = [bone.name for bone in BONES]
LIMBS = {
    "RightUpLeg": ("RightLeg", 2, "r_knee_x"),
    "LeftUpLeg": ("LeftLeg", 3, "l_knee_x"),
    "RightArm": ("RightForeArm", 6, "r_elbow_x"),
    "LeftArm": ("LeftForeArm", 7, "l_elbow_x"),
}
"""Of each upper bone the lower one, the cylinder of the body that it is, and the bend."""
AT_REST = {"RightUpLeg": "x", "LeftUpLeg": "x", "RightArm": "y", "LeftArm": "y"}
"""Arms stretched out, palms down: knees bend about left to right, elbows about the vertical."""


def posed(**angles_deg: float) -> np.ndarray:
    pose = rest_pose()
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


squatting = partial(posed, r_hip_x=80.0, l_hip_x=80.0, r_knee_x=-120.0, l_knee_x=-120.0)
"""Knees point outwards by what `r_hip_y` and `l_hip_y` say."""


def moved(poses: list[np.ndarray]) -> np.ndarray:
    return np.array([joints(BODY, pose) for pose in poses])


def world_turns(motion: Motion) -> dict[str, Rotation]:
    found: dict[str, Rotation] = {}
    for bone, own in zip(BONES, motion.turns, strict=False):
        found[bone.name] = found[NAMES[bone.parent]] * own if bone.parent >= 0 else own
    return found


def channels_of(text: str, bone: str) -> np.ndarray:
    """(n, 3) about z, x, y, as the file has them of a joint."""
    at = re.findall(r"(?:ROOT|JOINT) (\w+)", text).index(bone)
    return read_bvh(text).angles[:, 3 * at : 3 * at + 3]


@pytest.mark.parametrize("upper", LIMBS)
@pytest.mark.parametrize("outwards_deg", [-35.0, 0.0, 35.0])
def test_the_hinges_axis_is_the_bodys_own(upper: str, outwards_deg: float) -> None:
    """A body of known frames, whose knees and elbows turn about x of thighs and upper arms."""
    lower, limb, _ = LIMBS[upper]
    turned = {f"{side}_hip_y": sign * outwards_deg for side, sign in (("r", 1), ("l", -1))}
    turned |= {"r_elbow_x": 70.0, "l_elbow_x": 70.0, "l_shoulder_x": outwards_deg}
    poses = [squatting(**turned), squatting(**turned, torso_y=40.0)]
    joints_m = moved(poses)
    skeleton = skeleton_of(joints_m)
    turns = world_turns(motion_of(skeleton, joints_m, np.arange(2) / 15))
    axis = np.eye(3)["xyz".index(AT_REST[upper])]
    for frame, pose in enumerate(poses):
        own = limb_frames(BODY, pose)[limb, 3:].reshape(3, 3)[:, 0]
        for bone in (upper, lower):
            assert abs(turns[bone].apply(axis)[frame] @ own) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_a_limb_that_is_bent_turns_about_one_channel_alone(seed: int) -> None:
    """And one that is nearly straight is beside its hinge's plane by less than STRAIGHT_DEG."""
    joints_m = random_joints(seed)
    skeleton, motion, steps = steady(joints_m, np.arange(40) / 15)
    text = bvh_text(skeleton, motion, steps.step_s)
    for upper, (lower, _, _) in LIMBS.items():
        own = {"x": 1, "y": 2}[AT_REST[upper]]
        angles = channels_of(text, lower)
        aside = np.abs(np.delete(angles, own, axis=1)).max(axis=1)
        bent = np.abs(angles[:, own]) > STRAIGHT_DEG + 1.0
        assert bent.any()
        assert aside[bent].max() < 1e-3, (upper, aside[bent].max())
        assert aside.max() < 0.75 * STRAIGHT_DEG, upper


def test_a_deep_squat_is_flexion_alone_from_the_first_frame_on() -> None:
    """In the model of OpenSim too: of a knee bent by 120 degrees rx is 120, rz and ry are 0."""
    joints_m = moved([squatting(r_hip_y=30.0, l_hip_y=-30.0)] * 3)
    _, motion, steps = steady(joints_m, np.arange(3) / 15)
    lines = mot_text(motion, steps.step_s, "squat.mot").splitlines()
    names, first = (line.split("\t") for line in lines[lines.index("endheader") + 1 :][:2])
    read = dict(zip(names, map(float, first), strict=True))
    for side in ("Left", "Right"):
        assert read[f"{side}Leg_rx"] == pytest.approx(120.0, abs=0.01)
        assert abs(read[f"{side}Leg_rz"]) + abs(read[f"{side}Leg_ry"]) < 0.01


@pytest.mark.parametrize("rate_hz", [15.0, 60.0])
@pytest.mark.parametrize("seed", range(4))
def test_the_twist_of_a_limb_that_is_straight_for_a_while_goes_over_slowly(
    seed: int, rate_hz: float
) -> None:
    """Joints 4 mm off; the left arm, bent ahead before 24 straight frames, is bent upwards then."""
    bends = [*np.linspace(60.0, 0.0, 8), *[0.0] * 24, *np.linspace(0.0, 60.0, 8)]
    joints_m = moved(
        [
            posed(l_shoulder_z=270.0, l_shoulder_y=0.0 if i < 20 else -90.0, l_elbow_x=bend)
            for i, bend in enumerate(bends)
        ]
    )
    joints_m += np.random.default_rng(seed).normal(0.0, 0.004, joints_m.shape)
    twists = turned_axes(skeleton_of(joints_m), joints_m, np.arange(40) / rate_hz).twists
    assert np.degrees(np.abs(np.diff(np.unwrap(twists)))).max() < 20.0
    left_deg = np.degrees(np.unwrap(twists[list(HINGES).index("LeftArm")]))
    assert left_deg[[0, -1]] == pytest.approx([0.0, -90.0], abs=8.0)


def test_elbows_that_bend_ahead_with_arms_stretched_out_twist_nothing() -> None:
    """As at rest: the left forearm turns about the vertical by -70 degrees, the right one by 70."""
    aside = {"l_shoulder_z": 270.0, "r_shoulder_z": 90.0, "l_shoulder_y": 0.0, "r_shoulder_y": 0.0}
    joints_m = moved([posed(**aside, l_elbow_x=70.0, r_elbow_x=70.0)] * 2)
    skeleton, motion, steps = steady(joints_m, np.arange(2) / 15)
    text = bvh_text(skeleton, motion, steps.step_s)
    for lower, turn_deg in (("LeftForeArm", -70.0), ("RightForeArm", 70.0)):
        assert channels_of(text, lower)[0] == pytest.approx([0.0, 0.0, turn_deg], abs=1e-3)
        assert channels_of(text, lower.replace("Fore", ""))[0] == pytest.approx(0.0, abs=1e-3)


def test_how_fast_a_twist_goes_over_is_a_matter_of_seconds_and_not_of_frames() -> None:
    """A limb bent by 8 degrees whose plane is another by 90 degrees after one second."""
    found_deg = []
    for rate_hz in (15, 60):
        time_s = np.arange(2 * rate_hz + 1) / rate_hz
        bends = np.sin(np.radians(8.0)) * np.exp(1j * np.radians(np.where(time_s < 1.0, 0.0, 90.0)))
        found_deg.append(np.degrees(limb_twists(bends[None], time_s)[0, :: rate_hz // 15]))
    assert found_deg[0] == pytest.approx(found_deg[1], abs=8.0)
    assert 15.0 < found_deg[0][13] < 40.0, "0.13 s before"
    assert found_deg[0][[0, -1]] == pytest.approx([0.0, 90.0], abs=5.0)


def test_a_file_twists_limbs_by_the_times_of_its_rows() -> None:
    """Not by their number: the same poses within a quarter of the time go over as slowly."""
    poses = [
        posed(l_shoulder_z=270.0, l_shoulder_y=-90.0 * (i > 15), l_elbow_x=8.0) for i in range(31)
    ]
    joints_m, at = moved(poses), [bone.name for bone in BONES].index("LeftArm")
    steps_deg = []
    for rate_hz in (15, 60):
        _, motion, _ = steady(joints_m, np.arange(31) / rate_hz)
        turns = motion.turns[at]
        steps_deg.append(np.degrees((turns[:-1].inv() * turns[1:]).magnitude().max()))
    assert steps_deg[1] < 0.6 * steps_deg[0]


def test_between_twists_the_shorter_way_is_gone() -> None:
    """By hand: from 170 to -170 degrees over four steps, 5 degrees each, through 180."""
    bends = np.exp(1j * np.radians([[170.0, 0.0, 0.0, 0.0, -170.0]]))
    bends[0, 1:4] = 0.0
    twists_deg = np.degrees(limb_twists(bends, np.arange(5) / 15)) % 360.0
    assert twists_deg == pytest.approx(np.array([[170.0, 175.0, 180.0, 185.0, 190.0]]), abs=0.1)


def test_the_twist_moves_no_joint() -> None:
    joints_m = random_joints(7)
    skeleton = skeleton_of(joints_m)
    assert joints_of(skeleton, motion_of(skeleton, joints_m, np.arange(40) / 15)) == pytest.approx(
        joints_m, abs=1e-6
    )


def test_a_straight_limb_keeps_the_twist_of_the_frame_before_and_at_first_that_of_rest() -> None:
    bent, straight = moved([squatting(r_hip_y=30.0)])[:1], moved([posed()])
    skeleton = skeleton_of(np.concatenate([bent, straight]))
    at_s = np.array([0.0])
    before = turned_axes(skeleton, bent, at_s).twists[:, 0]
    assert abs(np.degrees(before[list(HINGES).index("RightUpLeg")])) > 25.0
    after = turned_axes(skeleton, straight, at_s + 0.1, Before(before, 0.0)).twists[:, 0]
    assert after == pytest.approx(before, abs=1e-3)
    assert turned_axes(skeleton, straight, at_s).twists[2:] == pytest.approx(0.0, abs=1e-6)


def test_of_a_first_frame_the_euler_angles_next_to_rest_are_taken() -> None:
    turns = Rotation.from_euler("x", [[120.0], [100.0], [80.0]], degrees=True)
    assert euler_zxy_deg([turns])[:, 0] == pytest.approx(
        np.array([[0.0, 120.0, 0.0], [0.0, 100.0, 0.0], [0.0, 80.0, 0.0]]), abs=1e-6
    )
