"""BVH, read back by a reader of its own: a hierarchy, turns in channel order, landmarks (T28)."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from clients import answer_of
from moving import BODY, random_joints
from scipy.spatial.transform import Rotation

from animator.bvh import bvh_text, euler_zxy_deg, steady
from animator.even_steps import NoMotion
from animator.skeleton.bones import joints_of
from common.body.body import JOINT_NAMES, rest_pose
from common.body.kinematics import joints

LANDMARKS = {
    "Hips": "pelvis",
    "Head": "neck",
    "Head end": "head_top",
    **{
        f"{side}{bone}": f"{side[0].lower()}_{joint}"
        for side in ("Left", "Right")
        for bone, joint in (
            ("Arm", "shoulder"),
            ("ForeArm", "elbow"),
            ("ForeArm end", "wrist"),
            ("UpLeg", "hip"),
            ("Leg", "knee"),
            ("Leg end", "ankle"),
        )
    },
}
"""Where each joint of the file belongs on the body."""


class Read(NamedTuple):
    places: dict[str, np.ndarray]
    """(n, 3) of every joint and end site."""
    parents: dict[str, str]
    angles: np.ndarray
    step_s: float


def read_bvh(text: str) -> Read:
    """What any program makes of a BVH: offsets and channels, multiplied down the hierarchy."""
    words = iter(text.split("MOTION", maxsplit=1)[0].split())
    joints_found: list[tuple[str, str, list[float], list[str]]] = []
    stack: list[str] = []
    for word in words:
        if word in ("ROOT", "JOINT", "End"):
            name = next(words)
            name = f"{stack[-1]} end" if word == "End" else name
            joints_found.append((name, stack[-1] if stack else "", [], []))
            stack.append(name)
        elif word == "}":
            stack.pop()
        elif word == "OFFSET":
            joints_found[-1][2].extend(float(next(words)) for _ in range(3))
        elif word == "CHANNELS":
            joints_found[-1][3].extend(next(words) for _ in range(int(next(words))))
    lines = text.split("MOTION")[1].strip().splitlines()
    table = np.array([[float(value) for value in line.split()] for line in lines[2:]])
    assert lines[0] == f"Frames: {len(table)}"
    places: dict[str, np.ndarray] = {}
    turns: dict[str, Rotation] = {}
    at = 0
    for name, parent, offset, channels in joints_found:
        place = np.tile(offset, (len(table), 1))
        turn = Rotation.identity(len(table))
        for channel in channels:
            axis, kind, values = channel[0], channel[1:], table[:, at]
            at += 1
            if kind == "position":
                place[:, "XYZ".index(axis)] += values
            else:
                turn = turn * Rotation.from_euler(axis, values[:, None], degrees=True)
        if parent:
            place = places[parent] + turns[parent].apply(place)
            turn = turns[parent] * turn
        places[name], turns[name] = place, turn
    assert at == table.shape[1]
    step_s = float(lines[1].split()[-1])
    return Read(places, {name: parent for name, parent, *_ in joints_found}, table[:, 3:], step_s)


@pytest.mark.parametrize("seed", range(8))
def test_the_skeleton_passes_through_the_joints_of_a_rigid_body(seed: int) -> None:
    """Within 1 mm, whatever the posture: lengths from the body, turns from its joints."""
    joints_m = random_joints(seed)
    skeleton, motion, steps = steady(joints_m, np.arange(40) / 15)
    read = read_bvh(bvh_text(skeleton, motion, steps.step_s))
    assert read.step_s == pytest.approx(1 / 15)
    for bone, landmark in LANDMARKS.items():
        off = np.linalg.norm(read.places[bone] - joints_m[:, JOINT_NAMES.index(landmark)], axis=1)
        assert off.max() < 1e-3, (bone, off.max())


def test_the_bones_have_the_lengths_of_the_body() -> None:
    """Offsets come from the BDPs: at rest the landmarks lie as far apart as the body's own."""
    joints_m = random_joints(3)
    rest = joints(BODY, rest_pose())
    skeleton, motion, steps = steady(joints_m, np.arange(40) / 15)
    read = read_bvh(bvh_text(skeleton, motion, steps.step_s))
    for bone in ("Head end", "LeftForeArm", "RightForeArm end", "LeftLeg", "RightLeg end"):
        ends = [JOINT_NAMES.index(LANDMARKS[name]) for name in (bone, read.parents[bone])]
        own = np.linalg.norm(read.places[bone] - read.places[read.parents[bone]], axis=1)
        assert own == pytest.approx(float(np.linalg.norm(np.subtract(*rest[ends]))), abs=1e-4)


def test_a_body_whose_lengths_change_is_followed_joint_by_joint() -> None:
    """A length that differs shifts its own landmark along the bone, not the rest of the limb."""
    joints_m = random_joints(5)
    elbow, wrist = JOINT_NAMES.index("l_elbow"), JOINT_NAMES.index("l_wrist")
    shoulder = JOINT_NAMES.index("l_shoulder")
    arm = joints_m[20, elbow] - joints_m[20, shoulder]
    joints_m[20, [elbow, wrist]] += 0.03 * arm / np.linalg.norm(arm)
    skeleton, motion, steps = steady(joints_m, np.arange(40) / 15)
    read = read_bvh(bvh_text(skeleton, motion, steps.step_s))
    assert np.linalg.norm(read.places["LeftForeArm"][20] - joints_m[20, elbow]) < 0.0301
    assert np.linalg.norm(read.places["LeftForeArm end"][20] - joints_m[20, wrist]) < 0.0301
    assert np.linalg.norm(read.places["LeftForeArm"][21] - joints_m[21, elbow]) < 1e-3


def test_frames_without_a_pose_lie_between_their_neighbours_and_keep_the_time() -> None:
    """Empty frames at the ends are left out; a gap of rows in the middle is filled."""
    whole = random_joints(1)
    holed = whole.copy()
    holed[[0, 1, 15, 16, 39]] = np.nan
    rows = np.delete(np.arange(40), [20, 21])
    skeleton, motion, steps = steady(holed[rows], rows / 15)
    read = read_bvh(bvh_text(skeleton, motion, steps.step_s))
    assert len(read.angles) == 37
    knee = JOINT_NAMES.index("r_knee")
    off = np.linalg.norm(read.places["RightLeg"] - whole[2:39, knee], axis=1)
    assert np.delete(off, [13, 14, 18, 19]).max() < 1e-3
    assert off.max() < 0.02


def test_turns_in_the_file_do_not_jump() -> None:
    """Programs draw curves through the frames: a jump of 360 degrees would spin a limb."""
    skeleton, motion, steps = steady(random_joints(2), np.arange(40) / 15)
    read = read_bvh(bvh_text(skeleton, motion, steps.step_s))
    assert np.abs(np.diff(read.angles, axis=0)).max() < 60.0


def test_euler_angles_mean_the_turn_they_are_of() -> None:
    turns = Rotation.random(500, random_state=4)
    again = Rotation.from_euler("ZXY", euler_zxy_deg([turns])[:, 0], degrees=True)
    assert np.allclose(again.as_matrix(), turns.as_matrix(), atol=1e-6)


def test_euler_angles_of_an_arm_that_goes_round_do_not_jump() -> None:
    """Twice round about x, through the tilt of 90 degrees where both triples meet."""
    degrees = np.arange(0.0, 720.0, 4.0) + 1.0
    turns = Rotation.from_euler("ZXY", [[20.0, each, 10.0] for each in degrees], degrees=True)
    angles = euler_zxy_deg([turns])[:, 0]
    assert np.abs(np.diff(angles, axis=0)).max() < 4.0 + 1e-6


@pytest.mark.parametrize(
    ("poses", "times", "why"),
    [
        (np.full((3, 15, 3), np.nan), [0.0, 1.0, 2.0], "0 frames have a pose"),
        (random_joints(0, 3), [0.0, 0.0, 1.0], "do not increase"),
        (random_joints(0, 5), [0.0, 1.0, 2.0, 3.0, 1e9], "at most"),
    ],
)
def test_what_cannot_be_animated_is_refused(
    poses: np.ndarray, times: list[float], why: str
) -> None:
    with pytest.raises(NoMotion, match=why):
        steady(poses, np.array(times))


BLENDER = """
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath=sys.argv[1], global_scale=0.01, update_scene_fps=True)
body, said = bpy.context.object, []
for frame in (1, 21, 40):
    bpy.context.scene.frame_set(frame)
    said.append({b.name: list(body.matrix_world @ b.head) for b in body.pose.bones})
print(json.dumps(said))
"""


@pytest.mark.slow
def test_blender_opens_it_in_centimetres(tmp_path: Path) -> None:
    """Its axes are +z up: (x, y, z) of the file is (x, -z, y) there."""
    skeleton, motion, steps = steady(random_joints(3), np.arange(40) / 15)
    (tmp_path / "body.bvh").write_text(bvh_text(skeleton, motion, steps.step_s, "cm"))
    said = answer_of("bpy", BLENDER, str(tmp_path / "body.bvh"))
    for frame, heads in zip((0, 20, 39), said, strict=True):
        expected = joints_of(skeleton, motion)[frame]
        for bone in skeleton.bones:
            x, y, z = expected[JOINT_NAMES.index(bone.starts)]
            assert heads[bone.name] == pytest.approx([x, -z, y], abs=1e-3)


def test_in_centimetres_every_length_is_a_hundred_times_as_long() -> None:
    skeleton, motion, steps = steady(random_joints(6), np.arange(40) / 15)
    metres, centimetres = (
        read_bvh(bvh_text(skeleton, motion, steps.step_s, scale)) for scale in ("m", "cm")
    )
    for name, places_m in metres.places.items():
        assert centimetres.places[name] == pytest.approx(100.0 * places_m, abs=1e-3), name
    assert centimetres.angles == pytest.approx(metres.angles)
