"""Our 15 joints out of 17 points: laws of turning and mirroring, and people worked by hand."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from common.body.body import JOINT_NAMES, OTHER_SIDE
from viewer.landmarks.fifteen_joints import Floats, facing_deg, fifteen, fifteen_shares
from viewer.landmarks.keypoint_layouts import BODY_POINTS, POINT

SIDES = {"l": "r", "r": "l"}
MIRRORED = [POINT[SIDES[name[0]] + name[1:] if name[1] == "_" else name] for name in BODY_POINTS]
NUDGES = np.random.default_rng(5).normal(0.0, 1e-6, (3, 17, 2))
places = arrays(np.float64, (17, 2), elements=st.floats(-100.0, 100.0))


def of(joints: Floats, name: str) -> Floats:
    return np.asarray(joints[JOINT_NAMES.index(name)])


def standing(width: float = 1.0, ahead: float = 0.0) -> Floats:
    """Somebody upright, 100 pixels tall to the ears; the nose so far to the right of these."""
    points = np.zeros((17, 2))
    for pair, half, row in [
        *(("eye", 2.0, 9.0), ("ear", 4.0, 10.0), ("shoulder", 10.0, 30.0), ("elbow", 14.0, 45.0)),
        *(("wrist", 15.0, 58.0), ("hip", 6.0, 60.0), ("knee", 6.0, 85.0), ("ankle", 6.0, 108.0)),
    ]:
        points[POINT[f"l_{pair}"]] = (50.0 + width * half, row)
        points[POINT[f"r_{pair}"]] = (50.0 - width * half, row)
    points[POINT["nose"]] = (50.0 + ahead, 11.0)
    return points


def test_limbs_are_taken_as_they_are_and_the_pelvis_lies_between_the_hips() -> None:
    joints = fifteen(standing())
    for name in JOINT_NAMES[3:]:
        np.testing.assert_array_equal(of(joints, name), standing()[POINT[name]])
    np.testing.assert_allclose(of(joints, "pelvis"), (50.0, 60.0))


def test_the_neck_lies_between_shoulders_and_ears_and_the_head_ends_above_these() -> None:
    joints = fifteen(standing())
    assert 20.0 < of(joints, "neck")[1] < 30.0
    assert -10.0 < of(joints, "head_top")[1] < 5.0
    assert of(joints, "neck")[0] == of(joints, "head_top")[0] == 50.0


@given(places, st.floats(-np.pi, np.pi), st.floats(0.1, 10.0), st.floats(-50.0, 50.0))
def test_a_body_that_is_turned_moved_or_larger_has_its_joints_there(
    points: Floats, angle: float, scale: float, shift: float
) -> None:
    cos, sin = np.cos(angle), np.sin(angle)
    turn = scale * np.array([[cos, sin], [-sin, cos]])
    np.testing.assert_allclose(
        fifteen(points @ turn + shift), fifteen(points) @ turn + shift, atol=1e-6
    )


@given(places)
def test_a_mirrored_body_has_mirrored_joints(points: Floats) -> None:
    mirror = np.array([-1.0, 1.0])
    np.testing.assert_allclose(
        fifteen(points[MIRRORED] * mirror), fifteen(points)[OTHER_SIDE] * mirror, atol=1e-9
    )


@pytest.mark.parametrize(
    ("points", "due_deg"),
    [
        (standing(), 0.0),
        (standing(width=-1.0), 180.0),
        (standing(width=0.0, ahead=6.0), 90.0),
        (standing(width=0.0, ahead=-6.0), -90.0),
    ],
    ids=["to the camera", "away from it", "to the right", "to the left"],
)
def test_shoulders_hips_and_nose_tell_the_facing(points: Floats, due_deg: float) -> None:
    assert facing_deg(points) == pytest.approx(due_deg)


@pytest.mark.parametrize("turned_deg", [-150, -120, -60, -30, 30, 60, 120, 150])
def test_between_these_the_facing_is_near(turned_deg: int) -> None:
    """Shoulders and hips of 32 pixels together, a nose that stands out by 4."""
    turned = np.radians(turned_deg)
    seen = standing(width=float(np.cos(turned)), ahead=4.0 * float(np.sin(turned)))
    assert facing_deg(seen) == pytest.approx(turned_deg, abs=1e-6)


@given(places)
def test_the_facing_of_a_mirrored_body_is_mirrored(points: Floats) -> None:
    """A body of no width faces anywhere: there the least nudge turns it."""
    mirror = np.array([-1.0, 1.0])
    assume(all(abs(facing_deg(points + nudge) - facing_deg(points)) < 1.0 for nudge in NUDGES))
    off = facing_deg(points[MIRRORED] * mirror) + facing_deg(points)
    assert min(abs(off), abs(abs(off) - 360.0)) == pytest.approx(0.0, abs=1e-6)


def test_a_joint_between_two_points_is_seen_as_well_as_the_worse() -> None:
    shares = np.linspace(0.0, 0.8, 17)
    seen = fifteen_shares(shares)
    assert of(seen, "l_knee") == shares[POINT["l_knee"]]
    assert of(seen, "pelvis") == shares[POINT["l_hip"]]
    assert of(seen, "neck") == shares[POINT["l_shoulder"]]
    assert of(seen, "head_top") == shares[POINT["l_ear"]]


@given(st.floats(-179.0, 179.0), st.floats(-6.0, 6.0), st.floats(0.2, 1.0))
def test_who_lies_faces_where_they_would_if_they_stood(
    lean_deg: float, ahead: float, width: float
) -> None:
    """From 30 degrees on: who leans by less is taken as they are in the picture."""
    a = np.radians(lean_deg)
    turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
    upright = facing_deg(standing(width, ahead))
    found = facing_deg(standing(width, ahead) @ turn)
    if abs(lean_deg) > 30.1:
        assert found == pytest.approx(upright, abs=1e-6)
    elif abs(lean_deg) < 29.9:
        assert np.cos(np.radians(found - upright)) > 0.0
