"""The feature vectors, held against the paper's list of angles and the body's own rotations."""

import numpy as np
import pytest
from acting import standing
from hypothesis import given
from hypothesis import strategies as st

from common.body.body import ANGLE_INDEX, ANGLES_IN_POSE, JOINT_NAMES, LIMBS, POSE_NAMES, rest_pose
from common.body.kinematics import limb_frames
from common.body.proportions import body_vector, thesis_bdp
from recognizer.features import (
    ANGLES,
    BEARING_NAMES,
    FEATURE_NAMES,
    bearings,
    features,
    rows,
    with_pose,
)

degrees = st.floats(-360.0, 360.0)
BODY = body_vector(thesis_bdp(1.75))
LIMB_OF = {"shoulder": "upper_arm", "elbow": "lower_arm", "hip": "upper_leg", "knee": "lower_leg"}
YAW = POSE_NAMES.index("torso_y")
angles = st.lists(st.floats(-180.0, 180.0), min_size=17, max_size=17)


def one(**angles_deg: float) -> np.ndarray:
    """The features (16,) of a standing body with some angles set."""
    row = standing(1)
    for name, angle_deg in angles_deg.items():
        row[0, ANGLE_INDEX[name]] = angle_deg
    return np.asarray(features(row)[0])


def direction(vector: np.ndarray, limb: str) -> list[float]:
    return [vector[FEATURE_NAMES.index(f"{limb}_{axis}")] for axis in ("right", "up", "forward")]


def rotated(x_deg: float, z_deg: float) -> np.ndarray:
    """Rz Rx (0, 1, 0), from the matrices of section 2.2."""
    x, z = np.radians([x_deg, z_deg])
    rx = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    rz = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    return np.asarray(rz @ rx @ np.array([0.0, 1.0, 0.0]))


def test_ten_angles_are_the_papers() -> None:
    """P57: theta_X, theta_Z of both shoulders, theta_X of both elbows, both of both hips."""
    two = {
        f"{side}_{joint}_{axis}" for side in "rl" for joint in ("shoulder", "hip") for axis in "xz"
    }
    assert len(ANGLES) == 10
    assert set(ANGLES) == two | {"r_elbow_x", "l_elbow_x"}


def test_features_depend_on_the_ten_angles_and_on_no_other() -> None:
    """P57."""
    base = standing(1)
    changing = set()
    for name, column in ANGLE_INDEX.items():
        moved = base.copy()
        moved[0, column] += 20.0
        if not np.allclose(features(moved), features(base)):
            changing.add(name)
    assert changing == set(ANGLES)


@given(degrees, degrees, st.sampled_from(["r_shoulder", "l_shoulder", "r_hip", "l_hip"]))
def test_a_limb_is_the_direction_that_the_papers_rotations_give(
    x_deg: float, z_deg: float, limb: str
) -> None:
    """Section 2.2 with C3, C4; the body's right is -x."""
    seen = direction(one(**{f"{limb}_x": x_deg, f"{limb}_z": z_deg}), limb)
    x, y, z = rotated(x_deg, z_deg)
    assert seen == pytest.approx([-x, y, z], abs=1e-9)


@pytest.mark.parametrize(
    ("limb", "x_deg", "z_deg", "points"),
    [
        ("r_shoulder", 0.0, 0.0, [0, 1, 0]),
        ("r_shoulder", 0.0, 90.0, [1, 0, 0]),
        ("l_shoulder", 0.0, 270.0, [-1, 0, 0]),
        ("l_hip", 90.0, 180.0, [0, 0, 1]),
    ],
    ids=["up", "right arm out", "left arm out", "thigh raised forward"],
)
def test_printed_angles_point_where_they_should(
    limb: str, x_deg: float, z_deg: float, points: list[float]
) -> None:
    """C3, C4."""
    seen = direction(one(**{f"{limb}_x": x_deg, f"{limb}_z": z_deg}), limb)
    assert seen == pytest.approx(points, abs=1e-9)


@pytest.mark.parametrize("name", ["r_shoulder_x", "l_shoulder_x", "r_elbow_x", "l_elbow_x"])
def test_179_and_minus_179_degrees_are_neighbours(name: str) -> None:
    """P57: two degrees apart, not 358 (a limb of length 1 moves by 2 pi / 180)."""
    apart = np.linalg.norm(one(**{name: 179.0}) - one(**{name: -179.0}))
    assert apart == pytest.approx(np.radians(2.0), rel=1e-3)


@given(degrees)
def test_an_arm_straight_forward_has_one_feature_whatever_theta_z(z_deg: float) -> None:
    """The pair of angles is degenerate there; the limb is not."""
    seen = one(r_shoulder_x=90.0, r_shoulder_z=z_deg)
    assert seen == pytest.approx(one(r_shoulder_x=90.0, r_shoulder_z=0.0), abs=1e-9)


@given(degrees, degrees)
def test_twin_angles_of_one_direction_are_one_feature(x_deg: float, z_deg: float) -> None:
    twin = one(l_hip_x=180.0 - x_deg, l_hip_z=z_deg + 180.0)
    assert twin == pytest.approx(one(l_hip_x=x_deg, l_hip_z=z_deg), abs=1e-9)


def test_frames_without_a_pose_are_dropped() -> None:
    angles_deg = standing(5)
    angles_deg[1] = np.nan
    angles_deg[3, ANGLE_INDEX["l_elbow_x"]] = np.nan
    angles_deg[4, ANGLE_INDEX["torso_y"]] = np.nan
    assert len(with_pose(angles_deg)) == 2
    assert with_pose(np.full((4, 20), np.nan)).shape == (0, 20)


@given(st.floats(0.1, 10.0))
def test_places_count_in_leg_lengths(scale: float) -> None:
    """A pelvis at 1.2 m over legs of 0.5 m and 0.3 m is 1.5 legs up, at any scale of the world."""
    joints_m = np.zeros((2, len(JOINT_NAMES), 3))
    place = {"pelvis": (0.8, 1.2, 0.4), "r_hip": (0, 1.2, 0), "r_knee": (0, 0.7, 0)}
    place["r_ankle"] = (0, 0.7, 0.3)
    for name, at in place.items():
        joints_m[0, JOINT_NAMES.index(name)] = at
    joints_m[1] = np.nan
    given = rows(np.zeros((2, 17)), scale * joints_m)
    assert given[0, 17:] == pytest.approx([1.0, 1.5, 0.5])
    assert len(with_pose(given)) == 1


def row(pose: np.ndarray, root: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> np.ndarray:
    return np.array([*pose[list(ANGLES_IN_POSE)], *root])


@given(angles)
def test_directions_are_the_axes_of_the_placed_limbs(angles_deg: list[float]) -> None:
    """C3, C4: R_z R_x R_y and the hinge, as the animated body has them, seen from the body."""
    pose = rest_pose()
    pose[list(ANGLES_IN_POSE)] = angles_deg
    seen = dict(zip(BEARING_NAMES, bearings(row(pose)[np.newaxis])[0], strict=True))
    pose[YAW] = 0.0
    frames = limb_frames(BODY, pose)
    for side in "rl":
        for joint, limb in LIMB_OF.items():
            axis = frames[LIMBS.index(f"{side}_{limb}"), [4, 7, 10]]
            found = [seen[f"{side}_{joint}_{c}"] for c in "xyz"]
            assert found == pytest.approx(axis, abs=1e-9)


@given(st.floats(-360.0, 360.0))
def test_travel_is_seen_from_the_body_wherever_it_faces(yaw_deg: float) -> None:
    """A person who walks ahead by 0.1 leg lengths a frame has gone 0.5 of them in five."""
    pose = rest_pose()
    pose[YAW] = yaw_deg
    yaw = np.radians(yaw_deg)
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])  # R_y (0, 0, 1)
    walked = np.stack([row(pose, tuple(0.1 * i * ahead)) for i in range(8)])
    travel = bearings(walked)[:, -3:] / bearings(walked)[-1, -1]
    assert travel[5:] == pytest.approx(np.tile([0.0, 0.0, 1.0], (3, 1)), abs=1e-9)
    assert travel[:5, 2] == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8], abs=1e-9)


def test_where_somebody_stands_is_no_feature() -> None:
    here, there = (np.tile(row(rest_pose(), root), (6, 1)) for root in ((0, 1, 0), (3, 2, -4)))
    assert bearings(here).tolist() == bearings(there).tolist()


def test_travel_counts_twice_a_direction_to_the_side_up_and_ahead() -> None:
    """Over 5 frames: 0.1 leg lengths along +x, 0.2 up, 0.3 along +z; the body faces 90 degrees
    about the vertical, towards +x: what was along +z is to its other side."""
    pose = rest_pose()
    steps = np.array([0.02, 0.04, 0.06])
    ahead = bearings(np.stack([row(pose, tuple(i * steps)) for i in range(7)]))[-1, -3:]
    assert ahead == pytest.approx([0.2, 0.4, 0.6])
    pose[YAW] = 90.0
    turned = bearings(np.stack([row(pose, tuple(i * steps)) for i in range(7)]))[-1, -3:]
    assert turned == pytest.approx([-0.6, 0.4, 0.2])
