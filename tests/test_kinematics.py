"""Ten cylinders and their chain, held against section 2 and against scipy's rotations."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import BODY, posed
from scipy.spatial.transform import Rotation

from common.body.body import (
    JOINT_NAMES,
    LIMBS,
    POSE_INDEX,
    Elliptic,
    Vector,
    body_of_lengths,
    rest_pose,
)
from common.body.kinematics import FRAME, joints, limb_frames, place_limbs, segments
from common.body.proportions import body_vector, thesis_bdp

degrees = st.floats(-360.0, 360.0)
poses = st.lists(degrees, min_size=22, max_size=22).map(
    lambda angles: np.array([0.3, 0.9, -0.4, *angles])
)


def axis(limb: str, **angles_deg: float) -> Vector:
    """Where a limb of a standing body points, world, unit length."""
    first, last = segments(BODY, posed(**angles_deg))[LIMBS.index(limb)]
    return np.asarray((last - first) / np.linalg.norm(last - first))


def spherical(x_deg: float, y_deg: float, z_deg: float) -> Rotation:
    """R_z R_x R_y of section 2.2, by scipy."""
    return Rotation.from_euler("ZXY", [z_deg, x_deg, y_deg], degrees=True)


@pytest.mark.parametrize(
    ("limb", "angles_deg", "points"),
    [
        ("r_upper_arm", {"r_shoulder_z": 0.0}, [0, 1, 0]),
        ("r_upper_arm", {"r_shoulder_z": 90.0}, [-1, 0, 0]),
        ("r_upper_arm", {}, [0, -1, 0]),
        ("l_upper_arm", {"l_shoulder_z": 270.0}, [1, 0, 0]),
        ("l_upper_leg", {}, [0, -1, 0]),
        ("r_upper_leg", {"r_hip_x": 90.0}, [0, 0, 1]),
        ("l_upper_arm", {"l_shoulder_x": -90.0}, [0, 0, -1]),
    ],
    ids=["up", "right out", "hanging", "left out", "leg down", "thigh forward", "arm back"],
)
def test_limbs_point_where_the_conventions_say(
    limb: str, angles_deg: dict[str, float], points: list[float]
) -> None:
    """C3, C4, P8: the person's right is -x, forward is +z."""
    assert axis(limb, **angles_deg) == pytest.approx(points, abs=1e-12)


@given(poses)
def test_the_chain_is_the_papers_transforms(pose: Vector) -> None:
    """P8: M_W^N = T R_y R_x (R_z innermost), M_N^S = T R_z R_x R_y, M_S^F = T R_x."""
    frames = limb_frames(BODY, pose)
    value = {name: pose[i] for name, i in POSE_INDEX.items()}
    navel = Rotation.from_euler(
        "YXZ", [value["torso_y"], value["torso_x"], value["torso_z"]], degrees=True
    )
    for side, sign in (("r", -1.0), ("l", 1.0)):
        for joint, upper, lower, place in (
            ("shoulder", "upper_arm", "lower_arm", (sign * BODY[26], BODY[27], 0.0)),
            ("hip", "upper_leg", "lower_leg", (sign * BODY[28], 0.0, 0.0)),
        ):
            x, y, z = (value[f"{side}_{joint}_{a}"] for a in "xyz")
            turned = navel * spherical(x, y, z)
            frame = frames[LIMBS.index(f"{side}_{upper}")]
            origin = pose[:3] + navel.apply(place)
            assert frame[:3] == pytest.approx(origin, abs=1e-12)
            assert frame[3:] == pytest.approx(turned.as_matrix().ravel(), abs=1e-12)
            length = getattr(thesis_bdp(1.0), f"{side}_{upper}").height
            hinge = value[f"{side}_{'elbow' if joint == 'shoulder' else 'knee'}_x"]
            frame = frames[LIMBS.index(f"{side}_{lower}")]
            assert frame[:3] == pytest.approx(origin + turned.apply([0, length, 0]), abs=1e-12)
            bent = turned * Rotation.from_euler("x", hinge, degrees=True)
            assert frame[3:] == pytest.approx(bent.as_matrix().ravel(), abs=1e-12)


@given(poses)
def test_every_frame_is_a_rotation(pose: Vector) -> None:
    """P8."""
    for frame in limb_frames(BODY, pose):
        turned = frame[3:].reshape(3, 3)
        assert turned @ turned.T == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(turned) == pytest.approx(1.0)


def test_the_order_of_the_navels_turns_matters() -> None:
    """P8: R_y R_x and R_x R_y differ by 0.17 for (x, y) = (30, 20) degrees; ours is the first."""
    turned = limb_frames(BODY, posed(torso_x=30.0, torso_y=20.0))[0, 3:].reshape(3, 3)
    x, y = (Rotation.from_euler(a, d, degrees=True) for a, d in (("x", 30.0), ("y", 20.0)))
    assert turned == pytest.approx((y * x).as_matrix(), abs=1e-12)
    assert np.abs(turned - (x * y).as_matrix()).max() == pytest.approx(0.17, abs=5e-3)


@given(st.floats(0.0, 180.0), st.floats(-140.0, 140.0))
def test_both_signs_of_theta_y_span_the_same_poses(shoulder_deg: float, elbow_deg: float) -> None:
    """C5: (+90, e) and (-90, -e) are twins."""
    one = posed(r_shoulder_z=shoulder_deg, r_shoulder_y=90.0, r_elbow_x=elbow_deg)
    twin = posed(r_shoulder_z=shoulder_deg, r_shoulder_y=-90.0, r_elbow_x=-elbow_deg)
    assert segments(BODY, one) == pytest.approx(segments(BODY, twin), abs=1e-12)


@pytest.mark.parametrize(("side", "sign"), [("r", -1.0), ("l", 1.0)])
def test_positive_flexion_of_a_hanging_arm_bends_outwards_and_up(side: str, sign: float) -> None:
    """C5: within the frontal plane, by the theta_Y of a resting body; -theta_Y bends inwards."""
    outward = posed()[POSE_INDEX[f"{side}_shoulder_y"]]
    out = axis(f"{side}_lower_arm", **{f"{side}_elbow_x": 60.0})
    assert out == pytest.approx([sign * np.sin(np.pi / 3), -0.5, 0.0], abs=1e-12)
    inwards = {f"{side}_elbow_x": 60.0, f"{side}_shoulder_y": -outward}
    assert axis(f"{side}_lower_arm", **inwards) == pytest.approx([-out[0], -0.5, 0], abs=1e-12)


@given(st.floats(0.0, 75.0))
def test_a_knee_bent_twice_as_far_keeps_the_foot_under_the_hip(hip_deg: float) -> None:
    """C6, P34: exact for thigh = shank."""
    leg = Elliptic(0.05, 0.05, 0.28)
    equal = msgspec.structs.replace(
        thesis_bdp(1.0), **{f"{s}_{p}_leg": leg for s in "rl" for p in ("upper", "lower")}
    )
    limb = segments(body_vector(equal), posed(r_hip_x=hip_deg, r_knee_x=-2.0 * hip_deg))
    hip, foot = limb[LIMBS.index("r_upper_leg"), 0], limb[LIMBS.index("r_lower_leg"), 1]
    assert foot[[0, 2]] == pytest.approx(hip[[0, 2]], abs=1e-12)


def test_with_the_thesis_legs_the_foot_is_three_percent_off() -> None:
    """C6: thigh 46, shank 52: 0.03 statures at 60 degrees."""
    limb = segments(BODY, posed(r_hip_x=60.0, r_knee_x=-120.0))
    off = limb[LIMBS.index("r_lower_leg"), 1, 2] - limb[LIMBS.index("r_upper_leg"), 0, 2]
    assert abs(off) == pytest.approx(0.03, abs=2e-3)


def test_landmarks_of_a_standing_body_lie_where_bodies_bend() -> None:
    """Mean adults: hip 0.530, knee 0.285, ankle 0.039 statures high, shoulders 0.20 apart."""
    places = dict(zip(JOINT_NAMES, joints(BODY, rest_pose()), strict=True))
    sole = segments(BODY, rest_pose())[:, :, 1].min()
    stature = places["head_top"][1] - sole
    for name, height in (("hip", 0.530), ("knee", 0.285), ("ankle", 0.039)):
        for side in "rl":
            assert (places[f"{side}_{name}"][1] - sole) / stature == pytest.approx(height)
    across = places["l_shoulder"][0] - places["r_shoulder"][0]
    assert across == pytest.approx(0.20 * stature)
    assert places["pelvis"][1] == pytest.approx(places["l_hip"][1])
    assert places["l_shoulder"][0] == -places["r_shoulder"][0] > 0


@given(poses)
def test_landmarks_of_a_limb_keep_their_distances_while_it_is_straight(pose: Vector) -> None:
    """Elbow and wrist on the arm's line: what `joints_m` says of a straight arm is straight."""
    pose[POSE_INDEX["l_elbow_x"]] = 0.0
    places = dict(zip(JOINT_NAMES, joints(BODY, pose), strict=True))
    upper = places["l_elbow"] - places["l_shoulder"]
    lower = places["l_wrist"] - places["l_elbow"]
    assert np.linalg.norm(np.cross(upper, lower)) == pytest.approx(0.0, abs=1e-12)
    ratio = np.linalg.norm(lower) / np.linalg.norm(upper)
    assert ratio == pytest.approx(0.146 / 0.186, abs=0.01)  # forearm over upper arm, adults


@given(poses)
def test_joints_of_a_bent_body_lie_so_far_along_its_own_limbs(pose: Vector) -> None:
    """A body whose sides differ: each joint's way from the limb's beginning, walked by hand."""
    body = body_vector(body_of_lengths([0.2 + 0.01 * n for n in range(26)]))
    ends, frames = segments(body, pose), limb_frames(body, pose)
    turn = frames[0, 3:].reshape(3, 3)
    places = dict(zip(JOINT_NAMES, joints(body, pose), strict=True))
    assert places["pelvis"] == pytest.approx(pose[:3] + body[37] * turn[:, 1])
    assert places["neck"] == pytest.approx(ends[0, 1])
    assert places["head_top"] == pytest.approx(ends[1, 1])

    def walked(limb: str, way_m: float) -> Vector:
        for part in (f"{limb[0]}_upper{limb[1:]}", f"{limb[0]}_lower{limb[1:]}"):
            start, end = ends[LIMBS.index(part)]
            length_m = float(np.linalg.norm(end - start))
            if way_m <= length_m or "lower" in part:
                break
            way_m -= length_m
        return np.asarray(start + way_m * (end - start) / length_m)

    for k, (side, sign) in enumerate((("r", 1.0), ("l", -1.0))):
        inwards = sign * body[38] * turn[:, 0]
        shoulder, hip = (ends[LIMBS.index(f"{side}_upper_{part}"), 0] for part in ("arm", "leg"))
        assert places[f"{side}_shoulder"] == pytest.approx(shoulder + inwards)
        assert places[f"{side}_hip"] == pytest.approx(hip + body[37] * turn[:, 1])
        for name, at, limb, off in (
            ("elbow", 29, "arm", inwards),
            ("wrist", 31, "arm", inwards),
            ("knee", 33, "leg", 0.0),
            ("ankle", 35, "leg", 0.0),
        ):
            due = walked(f"{side}_{limb}", body[at + k]) + off
            assert places[f"{side}_{name}"] == pytest.approx(due, abs=1e-9)


def test_limbs_that_are_not_asked_for_are_left_alone_and_a_lower_one_has_its_upper() -> None:
    frames = np.full((10, FRAME), 7.0)
    pose = posed(r_shoulder_z=40.0, l_knee_x=-30.0, torso_y=20.0)
    place_limbs(BODY, pose, 1 << LIMBS.index("l_lower_leg"), frames)
    placed = [name for name, frame in zip(LIMBS, frames, strict=True) if (frame != 7.0).any()]
    assert placed == ["torso", "l_upper_leg", "l_lower_leg"]
    whole = limb_frames(BODY, pose)
    for name in placed:
        assert frames[LIMBS.index(name)] == pytest.approx(whole[LIMBS.index(name)])
