"""Marks beside joints' centres, held against cases worked by hand and bodies of known truth."""

import math

import numpy as np
import pytest
from staging import PERSON, RIG, standing

from common.body.body import JOINT_NAMES, OTHER_SIDE
from common.body.kinematics import joints
from common.body.proportions import body_vector
from integrator.landmarks import joint_marks, landmark_fusion
from integrator.landmarks.landmark_rays import AT, Rays
from integrator.proposal.network_weights import JOINTS

STATURE_M = 1.75
UP, FRONT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
LEFT = np.array([1.0, 0.0, 0.0])


def figure(
    arm: np.ndarray = -UP,
    forearm: np.ndarray = -UP,
    thigh: np.ndarray = -UP,
    shank: np.ndarray = -UP,
) -> np.ndarray:
    """The twelve joints of a person who faces z, both sides alike, in statures."""
    places = {}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        places[f"{side}_shoulder"] = np.array([sign * 0.1, 0.8, 0.0])
        places[f"{side}_elbow"] = places[f"{side}_shoulder"] + 0.15 * arm
        places[f"{side}_wrist"] = places[f"{side}_elbow"] + 0.15 * forearm
        places[f"{side}_hip"] = np.array([sign * 0.06, 0.53, 0.0])
        places[f"{side}_knee"] = places[f"{side}_hip"] + 0.25 * thigh
        places[f"{side}_ankle"] = places[f"{side}_knee"] + 0.25 * shank
    return np.array([places[name] for name in JOINTS])


def at(name: str) -> int:
    return JOINTS.index(name)


@pytest.mark.parametrize(
    ("arm", "above"),
    [(-UP, 0.0185), (FRONT, 0.004), (UP, -0.0105)],
    ids=["hanging", "level", "straight up"],
)
def test_a_shoulder_sinks_below_its_mark_with_a_hanging_arm_and_rises_with_a_lifted_one(
    arm: np.ndarray, above: float
) -> None:
    beside = joint_marks.marks(figure(arm, arm))
    for side in "lr":
        np.testing.assert_allclose(
            beside[at(f"{side}_shoulder")], above * UP - 0.006 * FRONT, atol=1e-9
        )


def test_of_who_stands_the_marks_of_knees_are_before_and_outside_and_of_ankles_outside() -> None:
    beside = joint_marks.marks(figure())
    for side, out in (("l", LEFT), ("r", -LEFT)):
        np.testing.assert_allclose(beside[at(f"{side}_hip")], -0.008 * UP, atol=1e-9)
        np.testing.assert_allclose(
            beside[at(f"{side}_knee")], 0.005 * FRONT + 0.005 * out, atol=1e-9
        )
        np.testing.assert_allclose(beside[at(f"{side}_ankle")], 0.005 * out, atol=1e-9)
        np.testing.assert_allclose(beside[at(f"{side}_wrist")], 0.0, atol=1e-9)


def test_of_who_sits_hips_are_marked_at_the_crease_and_knees_inside_their_bends() -> None:
    """A right angle has half of what a folded limb has, along its bisector."""
    beside = joint_marks.marks(figure(thigh=FRONT, shank=-UP))
    inside = 0.03 * 0.5 * (-UP - FRONT) / math.sqrt(2.0)
    for side, out in (("l", LEFT), ("r", -LEFT)):
        np.testing.assert_allclose(beside[at(f"{side}_hip")], 0.005 * UP, atol=1e-9)
        np.testing.assert_allclose(beside[at(f"{side}_knee")], inside + 0.005 * out, atol=1e-9)


def test_a_bent_elbow_is_proposed_twice_as_far_inside_as_it_is_seen() -> None:
    bent = figure(forearm=FRONT)
    seen, proposed = joint_marks.bent(bent, 0.03, 0.03), joint_marks.bent(bent, 0.06, 0.03)
    inside = 0.03 * 0.5 * (FRONT + UP) / math.sqrt(2.0)
    np.testing.assert_allclose(seen[at("l_elbow")], inside, atol=1e-9)
    np.testing.assert_allclose(proposed[at("r_elbow")], 2.0 * inside, atol=1e-9)
    np.testing.assert_allclose(seen[at("l_knee")], 0.0, atol=1e-9)


def walking(yaw_deg: float = 0.0) -> np.ndarray:
    pose = standing(torso_y=yaw_deg, l_hip_x=40.0, l_knee_x=-60.0, r_elbow_x=70.0)
    return np.asarray(joints(body_vector(PERSON), pose)[AT])


def test_marks_turn_with_the_person_and_are_mirrored_with_them() -> None:
    here, there = walking(), walking(90.0)
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    np.testing.assert_allclose(
        joint_marks.marks(there), joint_marks.marks(here) @ turn.T, atol=1e-6
    )
    order = [JOINTS.index(JOINT_NAMES[OTHER_SIDE[k]]) for k in AT]
    mirror = np.array([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(
        joint_marks.marks(mirror * here[order]), mirror * joint_marks.marks(here)[order], atol=1e-9
    )


def rays_at(places_m: np.ndarray, views: int = 2) -> Rays:
    """Rays of both cameras through places (12, 3); of one alone where the other sees no person."""
    centres_m = np.array([np.array(c.R).T @ -np.array(c.t) for c in RIG.cameras])
    along = places_m - centres_m[:, None]
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    along[views:] = 0.0
    sure = np.full((2, 12), 0.85)
    sure[views:] = 0.0
    rotations = np.array([c.R for c in RIG.cameras])
    nothing = np.zeros((2, 12, 3)), np.zeros((2, 12))
    return Rays(centres_m, along, sure, *nothing, rotations, (0.0, 0.0), (0.0, 0.0))


def remembered(joints_m: np.ndarray) -> landmark_fusion.Memory:
    found = landmark_fusion.step(None, joints_m, np.full(12, 0.8), rays_at(joints_m), STATURE_M)
    return found.memory._replace(joints_m=joints_m)


@pytest.mark.parametrize("yaw_deg", [0.0, 50.0])
def test_rays_through_the_marks_of_a_body_are_moved_through_its_joints(yaw_deg: float) -> None:
    true_m = walking(yaw_deg)
    seen = rays_at(true_m + STATURE_M * joint_marks.marks(true_m))
    seen = seen._replace(others=seen.directions)
    proposed_m = true_m + STATURE_M * joint_marks.bent(true_m, *joint_marks.PROPOSED_INSIDE)
    found_m, moved = joint_marks.centred(remembered(true_m), proposed_m, seen, STATURE_M)
    np.testing.assert_allclose(found_m, true_m, atol=1e-9)
    assert off_m(moved, true_m).max() < 1e-3
    np.testing.assert_array_equal(moved.others, moved.directions)
    assert off_m(seen, true_m).max() > 0.03


def test_at_the_first_instant_the_proposed_pose_tells_where_marks_are() -> None:
    """Its bends are little farther inside than the body's."""
    true_m = walking()
    seen = rays_at(true_m + STATURE_M * joint_marks.marks(true_m))
    proposed_m = true_m + STATURE_M * joint_marks.bent(true_m, *joint_marks.PROPOSED_INSIDE)
    found_m, moved = joint_marks.centred(None, proposed_m, seen, STATURE_M)
    proposed_off_m, found_off_m = (
        float(np.linalg.norm(each - true_m, axis=1).max()) for each in (proposed_m, found_m)
    )
    assert found_off_m < 0.4 * proposed_off_m
    assert off_m(moved, true_m).max() < 0.4 * off_m(seen, true_m).max()


def off_m(seen: Rays, places_m: np.ndarray) -> np.ndarray:
    away = places_m - seen.centres_m[:, None]
    along = (away * seen.directions).sum(axis=2, keepdims=True)
    return np.asarray(np.linalg.norm(away - along * seen.directions, axis=2))


def test_a_view_that_shows_no_person_gets_no_rays() -> None:
    true_m = walking()
    _, moved = joint_marks.centred(None, true_m, rays_at(true_m, views=1), STATURE_M)
    assert np.isfinite(moved.directions).all()
    assert not moved.directions[1].any()
    assert not moved.others.any()
