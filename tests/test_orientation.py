"""The way that a body faces one camera, held against how people walk and bend (T22)."""

import numpy as np
import pytest
from stick_posing import in_profile, stick_pose

from common.body.body import JOINT_NAMES
from common.body.stick_body import ADULT, BREADTH, X, joints_px
from common.notes.notes import Orientation
from integrator.single.orientation import (
    CONFIDENT_AT,
    FADING,
    FRONTAL,
    INERTIA,
    PROFILE,
    UNKNOWN_FRONT,
    WALKING,
    Bearing,
    faced,
)

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


def test_evidence_is_what_bends_and_steps_say_and_fades() -> None:
    """A step of a trunk's length, three trunks to a stature; bends of a whole profile."""
    pose = in_profile(stick_pose(STEP))
    places = joints_px(ADULT, pose)
    pelvis, neck = (places[JOINT_NAMES.index(name)] for name in ("pelvis", "neck"))
    trunk_px = float(np.linalg.norm(neck - pelvis))
    before = Bearing("right", 0.9, 0.4, 1.0, (float(pelvis[0]) - trunk_px, 50.0))
    bends = faced(Bearing(), places, 0.4).to_right
    assert bends > 0.0
    found = faced(before, places, 0.5)
    assert found.to_right == pytest.approx(FADING * 1.0 + bends + WALKING / 3.0)
    assert found.breadth == pytest.approx(INERTIA * 0.4 + (1.0 - INERTIA) * 0.5)
    assert found.at == pytest.approx((pelvis[0], trunk_px))
    odds = np.exp(found.to_right / CONFIDENT_AT)
    assert found.confidence == pytest.approx(odds / (1.0 + odds))


@pytest.mark.parametrize(
    ("was", "breadth", "now"),
    [
        ("right", FRONTAL - 0.01, "right"),
        ("right", FRONTAL + 0.01, "forward_right"),
        ("backward_left", PROFILE + 0.01, "backward_left"),
        ("backward_left", PROFILE - 0.01, "right"),
    ],
    ids=["profile stays", "profile turns", "back stays", "back turns"],
)
def test_a_profile_begins_where_a_trunk_is_thin_and_ends_where_it_is_broad(
    was: Orientation, breadth: float, now: Orientation
) -> None:
    places = joints_px(ADULT, in_profile(stick_pose(STEP)))
    before = Bearing(was, 0.6, breadth, 2.0, None)
    found = faced(before, places, breadth)
    assert found.orientation == now
    if now == was and was.startswith("backward"):
        assert found.confidence == 0.6
    if now.startswith("forward"):
        assert found.confidence == UNKNOWN_FRONT


def limbs_px(**places: tuple[float, float]) -> np.ndarray:
    """(15, 2) a body that hangs straight down, but for the joints that are given."""
    heights = {"head_top": 10, "neck": 20, "shoulder": 24, "elbow": 40, "wrist": 55, "pelvis": 60}
    heights |= {"hip": 62, "knee": 80, "ankle": 100}
    joints = [
        (50.0, float(heights.get(name, heights.get(name.rpartition("_")[2], 0))))
        for name in JOINT_NAMES
    ]
    for name, place in places.items():
        joints[JOINT_NAMES.index(name)] = place
    return np.array(joints)


@pytest.mark.parametrize(
    ("places", "says"),
    [
        ({}, 0.0),
        ({"l_ankle": (30.0, 80.0)}, 1.0),
        ({"r_wrist": (65.0, 40.0)}, 0.5),
        ({"l_ankle": (30.0, 80.0), "l_wrist": (38.0, 40.0)}, 0.5),
        # the thigh leans to the right by 0.6, the shank goes on to the right, level
        ({"r_knee": (63.5, 80.0), "r_ankle": (70.0, 80.0)}, -(1.0 - 0.6**2)),
        # the upper arm leans to the left by 0.6, the forearm goes straight down
        ({"l_elbow": (38.0, 40.0), "l_wrist": (38.0, 52.0)}, 0.5 * 0.8 * 0.6),
    ],
    ids=["straight", "knee", "elbow", "knee and elbow", "kick", "arm back"],
)
def test_knees_bend_backwards_elbows_forwards_by_the_sine_across(
    places: dict[str, tuple[float, float]], says: float
) -> None:
    """A twentieth of ten times what they say is new in a frame."""
    found = faced(Bearing(), limbs_px(**places), 0.5)
    assert found.to_right == pytest.approx(0.5 * says)
