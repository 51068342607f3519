"""What has the same outline, held against the projection and the drawn body (T21, T22, L4)."""

import numpy as np
import pytest

from common.body.body import JOINT_NAMES, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.rig.camera import paper_rig, project
from integrator.single.reflection import (
    Front,
    agrees,
    as_deep,
    faces,
    front_of,
    leaning,
    seen_from_behind,
    yaw_deg,
)

CAMERA = paper_rig((160, 120), (200.0, 200.0), (4.375, 4.375)).cameras[0]
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def body(yaw: float) -> np.ndarray:
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = yaw
    pose[POSE_INDEX["r_shoulder_x"]] = 60.0
    pose[POSE_INDEX["l_hip_x"]], pose[POSE_INDEX["l_knee_x"]] = 50.0, -60.0
    return np.asarray(joints(body_vector(thesis_bdp(1.75)), pose))


def test_joints_as_deep_as_others_stay_in_the_picture() -> None:
    seen, other = body(20.0), body(60.0) + np.array([0.2, 0.1, 0.3])
    moved = as_deep(CAMERA, seen, other)
    assert project(CAMERA, moved) == pytest.approx(project(CAMERA, seen))
    forward = np.array(CAMERA.R)[2]
    assert moved @ forward == pytest.approx(other @ forward)


@pytest.mark.parametrize("yaw", [-140.0, -40.0, 20.0, 120.0])
def test_from_behind_it_is_the_same_picture_and_faces_the_other_way(yaw: float) -> None:
    """L4: front and back cannot be told apart; sides change with them."""
    seen = body(yaw)
    other = seen_from_behind(CAMERA, seen)
    swapped = [AT[{"l_": "r_", "r_": "l_"}.get(n[:2], n[:2]) + n[2:]] for n in JOINT_NAMES]
    assert project(CAMERA, other)[swapped] == pytest.approx(project(CAMERA, seen))
    turned = yaw_deg(CAMERA, other)
    assert np.sign(turned) == np.sign(yaw)
    assert abs(turned) == pytest.approx(180.0 - abs(yaw), abs=5.0)


def test_a_limb_leans_as_told_and_is_seen_where_it_was() -> None:
    """T21: an arm that points to the camera points away from it, its hand too."""
    seen = body(0.0)
    other = leaning(CAMERA, seen, {"r_upper_arm": "away", "l_upper_leg": "toward"})
    assert project(CAMERA, other) == pytest.approx(project(CAMERA, seen))
    for near, far in (("r_shoulder", "r_elbow"), ("r_elbow", "r_wrist")):
        before, after = (j[AT[far], 2] - j[AT[near], 2] for j in (seen, other))
        assert (after < 0 < before) if far == "r_elbow" else after == pytest.approx(before, abs=0.1)
    assert other[AT["l_ankle"]] == pytest.approx(seen[AT["l_ankle"]])


def test_the_six_ways_are_named_by_the_yaw() -> None:
    """T22."""
    named = {-40.0: "forward_left", -90.0: "left", -140.0: "backward_left", 75.0: "right"}
    assert {yaw: faces(yaw) for yaw in named} == named
    assert faces(140.0) == "backward_right"
    assert agrees(-60.0, "left")
    assert not agrees(60.0, "left")


def test_front_turns_to_back_through_the_side_alone() -> None:
    """A proposal that jumps from front to back is seen from behind; through the side it is not."""
    front, behind = front_of(Front(), 150.0, None, None, 0.1)
    assert (front.away, behind) == (False, True)
    front, behind = front_of(front, 100.0, None, None, 0.1)
    assert (front.away, behind) == (False, False)
    assert front_of(front, 150.0, None, None, 0.1) == (Front(away=True, first=False), False)


def test_who_insists_is_believed_and_the_user_at_once() -> None:
    front = Front()
    for _ in range(40):
        front, behind = front_of(front, 150.0, None, None, 0.1)
    assert (front.away, behind) == (True, False)
    assert front_of(Front(), 150.0, None, "backward_right", 0.1) == (
        Front(away=True, first=False),
        False,
    )
    assert front_of(Front(), 150.0, None, "forward_right", 0.1)[1]


def test_a_first_picture_that_surely_shows_a_back_is_believed_and_no_proposal_insists() -> None:
    front = Front()
    for _ in range(40):  # 4 s
        front, behind = front_of(front, -5.0, -150.0, None, 0.1)
        assert (front.away, behind) == (True, True)
    assert front_of(front, -5.0, None, None, 0.1) == (Front(True, False, 0.1, first=False), True)


def test_a_picture_that_shows_nearly_a_profile_tells_nothing() -> None:
    for shown_deg in (-60.0, 60.0, 125.0):
        assert front_of(Front(), 5.0, shown_deg, None, 0.1)[0] == Front(first=False)
        assert front_of(Front(aside=True), 150.0, shown_deg, None, 0.1)[0].away


def test_a_picture_turns_nobody_about_who_was_not_seen_from_the_side() -> None:
    """Landmarks take front for back for long at a time, and nobody turns at once."""
    front = Front(first=False)
    assert front_of(front, 5.0, 170.0, None, 0.1) == (front, False)
    aside = front_of(front, 95.0, 170.0, None, 0.1)[0]
    assert front_of(aside, 5.0, 170.0, None, 0.1) == (Front(True, False, 0.0, first=False), True)
