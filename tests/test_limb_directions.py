"""The richer feature vector, held against the body's own chain of coordinate systems."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.body.body import ANGLES_IN_POSE, LIMBS, POSE_NAMES, rest_pose
from common.body.kinematics import limb_frames
from common.body.proportions import body_vector, thesis_bdp
from recognizer.limb_directions import BEARING_NAMES, bearings

BODY = body_vector(thesis_bdp(1.75))
LIMB_OF = {"shoulder": "upper_arm", "elbow": "lower_arm", "hip": "upper_leg", "knee": "lower_leg"}
YAW = POSE_NAMES.index("torso_y")
angles = st.lists(st.floats(-180.0, 180.0), min_size=17, max_size=17)


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
