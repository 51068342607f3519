"""VMC, read back as Unity would: bones turned down the hierarchy stand where the joints are."""

import msgspec
import numpy as np
import pytest
from meeting import a_body
from moving import BODY, random_joints
from osc_reader import read_osc
from scipy.spatial.transform import Rotation

from animator.skeleton.bones import BONES
from common.body.body import JOINT_NAMES, POSE_INDEX, rest_pose
from common.body.extremities import extremities
from common.body.kinematics import joints
from common.bus.messages import Body, Posture
from runtime.bridges.vmc import MEASURED, Measured, posture_packet, step

pytest.importorskip("pythonosc", reason="pip install 'tritrack[osc]'")

PARENTS = {
    "Spine": "Hips",
    "Head": "Spine",
    **{
        f"{side}{bone}": parent if parent in {"Hips", "Spine"} else f"{side}{parent}"
        for side in ("Left", "Right")
        for bone, parent in (
            ("Shoulder", "Spine"),
            ("UpperArm", "Shoulder"),
            ("LowerArm", "UpperArm"),
            ("UpperLeg", "Hips"),
            ("LowerLeg", "UpperLeg"),
            ("Hand", "LowerArm"),
            ("Foot", "LowerLeg"),
        )
    },
}
"""Unity's humanoid hierarchy, as far as it is sent."""


def unity_places(packet: bytes) -> dict[str, np.ndarray]:
    """World places of the bones in Unity's axes.

    Mirrored in x, a left-handed turn (x, y, z, w) is the right-handed (x, -y, -z, w).
    """
    places: dict[str, np.ndarray] = {}
    turns: dict[str, Rotation] = {}
    for address, values in read_osc(packet):
        if address != "/VMC/Ext/Bone/Pos":
            continue
        name, place = values[0], np.array(values[1:4]) * (-1, 1, 1)
        x, y, z, w = values[4:]
        turn = Rotation.from_quat([x, -y, -z, w])
        parent = PARENTS.get(name)
        if parent is not None:
            place = places[parent] + turns[parent].apply(place)
            turn = turns[parent] * turn
        places[name], turns[name] = place, turn
    return {name: place * (-1, 1, 1) for name, place in places.items()}


def test_the_bones_stand_where_the_joints_are() -> None:
    joints_m, state = random_joints(6), Measured()
    for frame, row in enumerate(joints_m):
        ends = tuple(map(tuple, extremities(row, 1.75).tolist()))
        body = msgspec.structs.replace(a_body(frame, row), extremities_m=ends)
        state, packet = step(state, body)
    assert packet is not None
    assert len(state.poses) == MEASURED
    places = unity_places(packet)
    assert len(places) == len(BONES)
    for bone, joint in (("LeftUpperArm", "l_shoulder"), ("RightLowerArm", "r_elbow")):
        x, y, z = joints_m[-1, JOINT_NAMES.index(joint)]
        assert places[bone] == pytest.approx([-x, y, z], abs=1e-3)
    x, y, z = joints_m[-1, JOINT_NAMES.index("l_knee")]
    assert places["LeftLowerLeg"] == pytest.approx([-x, y, z], abs=1e-3)
    x, y, z = joints_m[-1, JOINT_NAMES.index("r_ankle")]
    assert places["RightFoot"] == pytest.approx([-x, y, z], abs=1e-3)


def test_who_faces_forward_has_the_right_hand_at_positive_x() -> None:
    """Unity: left-handed, +x is right of who faces +z."""
    row = np.zeros((15, 3))
    heights = {"pelvis": 0.9, "neck": 1.4, "head_top": 1.7}
    for i, name in enumerate(JOINT_NAMES):
        side = {"l": 1.0, "r": -1.0}.get(name[0], 0.0) if "_" in name and name[1] == "_" else 0.0
        reach = {"shoulder": 0.2, "elbow": 0.45, "wrist": 0.7}.get(name[2:], 0.1)
        height = heights.get(name, {"hip": 0.9, "knee": 0.5, "ankle": 0.1}.get(name[2:], 1.4))
        row[i] = (side * reach, height, 0.0)
    bare = {"extremities_m": (), "extremities_confidence": ()}  # toes point outwards
    _, packet = step(Measured(), msgspec.structs.replace(a_body(0, row), **bare))
    assert packet is not None
    places = unity_places(packet)
    assert places["RightLowerArm"][0] == pytest.approx(0.45, abs=1e-3)
    turns = [values[4:] for address, values in read_osc(packet) if "Bone" in address]
    assert all(abs(turn[3]) == pytest.approx(1.0, abs=1e-3) for turn in turns)


def test_a_knee_turns_about_left_to_right_alone_and_stays_so_where_the_leg_is_straight() -> None:
    """A thigh that is turned outwards; Unity mirrors x, so of a turn about x, y and z stay 0."""
    bent, straight = rest_pose(), rest_pose()
    for name, angle_deg in (("l_hip_x", 70.0), ("l_hip_y", 30.0), ("l_knee_x", -90.0)):
        bent[POSE_INDEX[name]] = angle_deg
    state, thighs = Measured(), []
    for frame, pose in enumerate((bent, straight)):
        body = msgspec.structs.replace(
            a_body(frame, joints(BODY, pose)), extremities_m=(), extremities_confidence=()
        )
        state, packet = step(state, body)
        turns = {
            each[0]: each[4:] for address, each in read_osc(packet or b"") if "Bone" in address
        }
        assert turns["LeftLowerLeg"][1:3] == pytest.approx([0.0, 0.0], abs=1e-5)
        thighs.append(turns["LeftUpperLeg"])
    assert abs(thighs[0][1]) > 0.2
    assert abs(thighs[1][1]) > 0.2


def test_nobody_moves_no_bone() -> None:
    body = Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")
    assert step(Measured(), body) == (Measured(), None)


def test_a_packet_begins_with_that_all_is_well_its_time_and_a_root_at_rest() -> None:
    """As the specification's performer says it: loaded, seconds, no turn of the root."""
    _, packet = step(Measured(), msgspec.structs.replace(a_body(9, random_joints(2)[0])))
    said = read_osc(packet or b"")
    assert [address for address, _ in said[:3]] == [
        "/VMC/Ext/OK",
        "/VMC/Ext/T",
        "/VMC/Ext/Root/Pos",
    ]
    assert [*said[0][1]] == [1]
    assert said[1][1][0] == pytest.approx(a_body(9, random_joints(2)[0]).captured_s)
    assert [*said[2][1]] == ["root", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def test_another_person_has_a_skeleton_of_their_own() -> None:
    """Of a body twice as large, as if nobody had been before."""
    rows, state = random_joints(3), Measured()
    for frame, row in enumerate(rows):
        first = msgspec.structs.replace(a_body(frame, row), person=1)
        state, _ = step(state, first)
    large = msgspec.structs.replace(a_body(9, 2 * rows[0]), person=2)
    _, packet = step(state, large)
    _, alone = step(Measured(), large)
    assert packet == alone


def test_the_posture_in_progress_is_a_blend_value_of_one_and_the_others_are_zero() -> None:
    """As an avatar's expressions are sent: each value, then the word to apply them."""
    known = {"walk": -3.0, "squat": -1.0}
    posture = Posture(
        frame=1, captured_s=0.1, clock_s=0.1, name="walk", doing="squat", log_likelihoods=known
    )
    assert read_osc(posture_packet(posture)) == [
        ("/VMC/Ext/Blend/Val", ["squat", 1.0]),
        ("/VMC/Ext/Blend/Val", ["walk", 0.0]),
        ("/VMC/Ext/Blend/Apply", []),
    ]
    stands = msgspec.structs.replace(posture, doing="")
    assert [told[1] for _, told in read_osc(posture_packet(stands))[:2]] == [0.0, 0.0]
