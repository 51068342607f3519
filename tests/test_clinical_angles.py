"""Clinical angles, held against bodies posed by hand: zeros, signs, and what is not defined."""

from pathlib import Path

import numpy as np
import pytest
from clients import answer_of
from clinical_model import SOLVED, osim_of, parts_of
from moving import BODY

from animator.clinical.clinical_angles import (
    NAMES,
    SIDE_NAMES,
    UNSEEN,
    clinical_angles,
    continuous,
    defined,
)
from animator.exchange.marker_files import trc_text
from common.body.body import OTHER_SIDE, POSE_INDEX, REST_DEG, rest_pose
from common.body.extremities import ALL_JOINT_NAMES, extremities
from common.body.kinematics import joints


def places(**angles_deg: float) -> np.ndarray:
    """The 22 joints of a standing body with some angles set, (1, 22, 3)."""
    pose = rest_pose()
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    joints_m = joints(BODY, pose)
    return np.concatenate([joints_m, extremities(joints_m, 1.75)])[None]


def angles_of(joints_m: np.ndarray, feet_seen: bool = True) -> dict[str, float]:
    """Angles by name; NaN where they are not defined."""
    found = clinical_angles(joints_m)
    known = defined(found, np.full((len(joints_m), 2), feet_seen))
    return dict(zip(NAMES, np.where(known, found, np.nan)[0].tolist(), strict=True))


def test_who_stands_and_faces_camera_1_has_zero_everywhere() -> None:
    told = angles_of(places())
    for name, angle_deg in told.items():
        assert np.isnan(angle_deg) or angle_deg == pytest.approx(0.0, abs=1.0), name
    assert not np.isnan(told["hip_flexion_r"])


@pytest.mark.parametrize(
    ("posed", "name", "angle_deg"),
    [
        ({"r_knee_x": -50.0}, "knee_angle_r", 50.0),
        ({"l_knee_x": -50.0}, "knee_angle_l", 50.0),
        ({"r_hip_x": 40.0}, "hip_flexion_r", 40.0),
        ({"l_hip_x": -20.0}, "hip_flexion_l", -20.0),
        ({"r_hip_z": 190.0}, "hip_adduction_r", 10.0),
        ({"l_hip_z": 210.0}, "hip_adduction_l", -30.0),
        ({"r_hip_y": -25.0, "r_knee_x": -60.0}, "hip_rotation_r", 25.0),
        ({"l_hip_y": 25.0, "l_knee_x": -60.0}, "hip_rotation_l", 25.0),
        ({"r_shoulder_x": 50.0}, "arm_flex_r", 50.0),
        ({"l_shoulder_x": -30.0}, "arm_flex_l", -30.0),
        ({"r_shoulder_z": 150.0}, "arm_add_r", -30.0),
        ({"l_shoulder_z": 210.0}, "arm_add_l", -30.0),
        ({"r_shoulder_z": 90.0}, "shoulder_elv_r", 90.0),
        ({"r_shoulder_z": 90.0}, "elv_angle_r", 0.0),
        ({"l_shoulder_x": 80.0}, "elv_angle_l", 90.0),
        ({"r_elbow_x": 70.0}, "elbow_flex_r", 70.0),
        ({"torso_y": 35.0}, "pelvis_rotation", 35.0),
        ({"torso_x": 20.0}, "pelvis_tilt", -20.0),
        ({"torso_z": 15.0}, "pelvis_list", 15.0),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_an_angle_has_its_sign_and_its_size(
    posed: dict[str, float], name: str, angle_deg: float
) -> None:
    """Flexion, adduction, inner rotation and turning to the left are more, as in OpenSim."""
    assert angles_of(places(**posed))[name] == pytest.approx(angle_deg, abs=0.5)


def test_the_forearm_tells_how_the_upper_arm_is_turned() -> None:
    """An elbow bent by a right angle, the forearm across the belly: turned inwards by 90."""
    joints_m = places()
    at = [ALL_JOINT_NAMES.index(name) for name in ("r_elbow", "r_wrist")]
    joints_m[0, at[1]] = joints_m[0, at[0]] + [0.25, 0.0, 0.0]
    assert angles_of(joints_m)["arm_rot_r"] == pytest.approx(90.0, abs=1.0)
    joints_m[0, at[1]] = joints_m[0, at[0]] + [-0.25, 0.0, 0.0]
    assert angles_of(joints_m)["arm_rot_r"] == pytest.approx(-90.0, abs=1.0)


def test_a_toe_that_is_lifted_is_more() -> None:
    joints_m = places()
    toe = ALL_JOINT_NAMES.index("l_toe")
    joints_m[0, toe, 1] += 0.1
    lifted, flat = angles_of(joints_m), angles_of(places())
    assert lifted["ankle_angle_l"] > flat["ankle_angle_l"] + 15.0
    assert np.isnan(angles_of(joints_m, feet_seen=False)["ankle_angle_l"])


def test_shoulders_that_turn_against_the_hips_turn_the_trunk_alone() -> None:
    joints_m = places()
    shoulders = [ALL_JOINT_NAMES.index(f"{side}_shoulder") for side in "lr"]
    middle = joints_m[0, shoulders].mean(axis=0)
    turn = np.array([[0.866, 0, 0.5], [0, 1, 0], [-0.5, 0, 0.866]])
    joints_m[0, shoulders] = middle + (joints_m[0, shoulders] - middle) @ turn.T
    told = angles_of(joints_m)
    assert told["lumbar_rotation"] == pytest.approx(30.0, abs=0.1)
    assert told["pelvis_rotation"] == pytest.approx(0.0, abs=0.1)


def test_the_mirror_image_has_the_other_sides_angles() -> None:
    """What is of a side changes sides; of the trunk, what is to a side changes its sign."""
    rng = np.random.default_rng(3)
    joints_m = places(r_knee_x=-60, l_hip_x=35, r_shoulder_x=45, l_elbow_x=50)
    joints_m = joints_m + rng.normal(0, 0.04, joints_m.shape)
    others = [*OTHER_SIDE, 15, 19, 20, 21, 16, 17, 18]
    mirrored = angles_of(joints_m[:, others] * [-1.0, 1.0, 1.0])
    told = angles_of(joints_m)
    for name in SIDE_NAMES:
        assert mirrored[f"{name}_l"] == pytest.approx(told[f"{name}_r"], nan_ok=True), name
    assert mirrored["pelvis_list"] == pytest.approx(-told["pelvis_list"])
    assert mirrored["pelvis_tilt"] == pytest.approx(told["pelvis_tilt"])
    assert mirrored["lumbar_bending"] == pytest.approx(-told["lumbar_bending"])


def test_what_the_joints_do_not_tell_is_empty() -> None:
    straight = angles_of(places())
    for name in (*UNSEEN, "hip_rotation_r", "arm_rot_l", "elv_angle_r"):
        assert np.isnan(straight[name]), name
    level = angles_of(places(r_shoulder_z=90.0, r_elbow_x=60.0))
    assert np.isnan(level["arm_flex_r"]), "an arm that is level to the side has no flexion"
    assert level["arm_add_r"] == pytest.approx(-90.0, abs=0.5)
    nobody = angles_of(np.full((1, 22, 3), np.nan))
    assert all(np.isnan(value) for value in nobody.values())


def test_an_angle_that_passes_180_goes_on_until_it_is_lost() -> None:
    turns = np.array([170.0, 179.0, -172.0, np.nan, -172.0])
    column = np.tile(turns[:, None], (1, len(NAMES)))
    assert continuous(column, np.isfinite(column))[:, 0].tolist() == pytest.approx(
        [170.0, 179.0, 188.0, np.nan, -172.0], nan_ok=True
    )


def test_standing_round_a_turn_changes_no_angle_of_a_limb() -> None:
    pose = {"r_knee_x": -40.0, "l_hip_x": 30.0, "r_shoulder_x": 25.0}
    told, turned = angles_of(places(**pose)), angles_of(places(**pose, torso_y=130.0))
    for name in NAMES[3:]:
        assert turned[name] == pytest.approx(told[name], abs=1e-6, nan_ok=True), name


def test_opensims_inverse_kinematics_finds_the_same_angles(tmp_path: Path) -> None:
    """In a model of its own conventions that is scaled to the person; markers in our TRC."""
    posed = {"torso_y": 40.0, "torso_x": 10.0, "r_hip_x": 45.0, "r_hip_z": 192.0, "r_hip_y": -20.0}
    posed |= {"r_knee_x": -70.0, "l_hip_x": -15.0, "l_knee_x": -35.0, "l_shoulder_x": 50.0}
    posed |= {"l_shoulder_z": 200.0, "l_elbow_x": 65.0, "r_shoulder_x": -25.0, "r_elbow_x": 40.0}
    rest = {name: REST_DEG.get(name, 0.0) for name in posed}
    joints_m = np.concatenate(
        [
            places(**{name: a + share * (posed[name] - a) for name, a in rest.items()})[:, :15]
            for share in np.linspace(0.0, 1.0, 30)
        ]
    )
    (tmp_path / "person.osim").write_text(osim_of(parts_of(joints_m)))
    (tmp_path / "markers.trc").write_text(trc_text(joints_m, 1 / 15, "markers.trc"))
    solved = answer_of(
        "opensim", SOLVED, str(tmp_path / "person.osim"), str(tmp_path / "markers.trc")
    )
    with_feet = np.concatenate([joints_m, np.full((30, 7, 3), np.nan)], axis=1)
    found = clinical_angles(with_feet)
    known = defined(found, np.zeros((30, 2), bool))
    shared = [name for name in NAMES if name in solved]
    assert len(shared) == 21
    for name in shared:
        at = NAMES.index(name)
        off_deg = (np.array(solved[name]) - found[:, at] + 180.0) % 360.0 - 180.0
        if known[:, at].any():
            assert np.median(np.abs(off_deg[known[:, at]])) < 2.0, name
