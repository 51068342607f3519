"""The way that a body faces one camera, held against how people walk and bend (T22)."""

import numpy as np
import pytest
from stick_posing import in_profile, stick_pose

from common.body.stick_body import ADULT, BREADTH, X, joints_px
from integrator.single.orientation import Bearing, faced

STEP = {"r_upper_leg": 285.0, "r_lower_leg": 262.0, "l_upper_leg": 262.0, "l_lower_leg": 228.0}
"""A stride to the right: knees bend backwards."""


def mirrored(turned_deg: dict[str, float]) -> dict[str, float]:
    return {name: 180.0 - angle_deg for name, angle_deg in turned_deg.items()}


def after(pose: np.ndarray, frames: int = 12, step_px: float = 0.0) -> Bearing:
    bearing = Bearing()
    for _ in range(frames):
        bearing = faced(bearing, joints_px(ADULT, pose), float(pose[BREADTH]))
        pose = pose.copy()
        pose[X] += step_px
    return bearing


def test_a_broad_trunk_faces_the_camera_until_somebody_says_otherwise() -> None:
    bearing = after(stick_pose({}))
    assert bearing.orientation.startswith("forward")
    assert bearing.confidence < 0.9


@pytest.mark.parametrize(("turned", "side"), [(STEP, "right"), (mirrored(STEP), "left")])
def test_knees_tell_left_from_right(turned: dict[str, float], side: str) -> None:
    bearing = after(in_profile(stick_pose(turned)))
    assert bearing.orientation == side
    assert bearing.confidence > 0.7


@pytest.mark.parametrize(("step_px", "side"), [(6.0, "right"), (-6.0, "left")])
def test_people_walk_where_they_face(step_px: float, side: str) -> None:
    bearing = after(in_profile(stick_pose({})), step_px=step_px)
    assert bearing.orientation == side
    assert bearing.confidence > 0.7


def test_a_frame_of_a_thin_trunk_is_no_profile() -> None:
    bearing = after(stick_pose({}))
    thin = in_profile(stick_pose({}))
    bearing = faced(bearing, joints_px(ADULT, thin), float(thin[BREADTH]))
    assert bearing.orientation.startswith("forward")
