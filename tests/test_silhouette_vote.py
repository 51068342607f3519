"""Doubts of one view, settled by two: poses whose silhouettes are drawn from known ones."""

import numpy as np
import pytest
from posing import posed
from staging import observation

from common.body.body import POSE_INDEX, POSE_NAMES, Vector
from common.body.kinematics import limb_frames
from common.body.observation import Observation
from common.body.proportions import (
    LOWER_LEG_HEIGHT,
    UPPER_LEG_HEIGHT,
    body_vector,
    thesis_bdp,
)
from common.method import DEFAULT
from common.raster.bits import count, pack_words
from common.raster.kernel import draw_body, view_of
from common.raster.similarity import Mask, similarity
from common.rig.camera import paper_rig
from integrator.fit.silhouette_pair import products, silhouettes_of
from integrator.paper.silhouette_vote import Vote, moving, settled, turned, votes_of

BODY = body_vector(thesis_bdp(1.75))
UPRIGHT_M = 0.95
LEG_M = float(BODY[UPPER_LEG_HEIGHT] + BODY[LOWER_LEG_HEIGHT])
SIZE = (160, 120)
RIG = paper_rig(SIZE, (200.0, 200.0), (4.5, 4.5))
VIEWS = np.array([view_of(camera) for camera in RIG.cameras])


def pictures(pose: Vector) -> list[Mask]:
    return [draw_body(BODY, pose, view, SIZE) for view in VIEWS]


def seen(pose: Vector) -> tuple[Observation, Observation]:
    first, second = pictures(pose)
    return observation(first), observation(second)


def standing(**angles_deg: float) -> Vector:
    """At the middle of the room."""
    pose = posed(**angles_deg)
    pose[:3] = 0.05, UPRIGHT_M, -0.1
    return pose


def test_a_product_is_that_of_the_similarities_of_whole_pictures() -> None:
    """P9, of both views, against the plain definition on masks."""
    truth = pictures(standing(r_shoulder_x=50.0))
    poses = np.array([standing(), standing(l_shoulder_z=230.0), standing(r_shoulder_x=50.0)])
    seen = np.array([pack_words(mask) for mask in truth])
    areas = np.array([count(mask) for mask in seen])
    found = products(BODY, poses, moving(poses), VIEWS, seen, areas, SIZE[0])
    for pose, value in zip(poses, found, strict=True):
        both = [similarity(*pair) for pair in zip(truth, pictures(pose), strict=True)]
        assert value == pytest.approx(both[0] * both[1], rel=1e-12)
    assert found[2] == 1.0


@pytest.mark.parametrize("name", POSE_NAMES)
def test_the_limbs_that_a_parameter_moves_are_those_whose_frames_change(name: str) -> None:
    """Only they are drawn again for each pose."""
    start = standing(r_elbow_x=20.0, l_elbow_x=20.0, r_knee_x=-20.0, l_knee_x=-20.0)
    other = start.copy()
    other[POSE_INDEX[name]] += 10.0
    moved = (limb_frames(BODY, start) != limb_frames(BODY, other)).any(axis=1)
    assert moving(np.array([start, other])) == sum(1 << int(i) for i in np.flatnonzero(moved))


def votes(fitted: bool) -> list[Vote]:
    """All of them."""
    return votes_of(DEFAULT, UPRIGHT_M, LEG_M, fitted)


@pytest.mark.parametrize(("side", "other"), [("r", "l"), ("l", "r")])
@pytest.mark.parametrize("wrong", ["both", "other"])
def test_the_arm_that_swings_is_told_from_the_one_that_hangs(
    side: str, other: str, wrong: str
) -> None:
    """L3: the flank took the other arm, or both; the facade shows which one left the trunk."""
    apart = {"r_shoulder_z": 165.0, "l_shoulder_z": 195.0}
    truth = standing(**apart, **{f"{side}_shoulder_x": 80.0})
    said = {f"{other}_shoulder_x": 80.0} | ({f"{side}_shoulder_x": 80.0} if wrong == "both" else {})
    found = settled(
        standing(**apart, **said),
        standing(**apart),
        BODY,
        silhouettes_of(RIG, seen(truth)),
        votes(False),
    )
    assert found[POSE_INDEX[f"{side}_shoulder_x"]] == 80.0
    assert found[POSE_INDEX[f"{other}_shoulder_x"]] == 0.0


def test_a_lost_arm_is_found_hanging() -> None:
    """L1: errors do not go on for ever."""
    pose = standing(l_shoulder_z=280.0, l_shoulder_x=100.0, l_elbow_x=90.0)
    found = settled(pose, pose, BODY, silhouettes_of(RIG, seen(standing())), votes(False))
    assert found == pytest.approx(standing())


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_body_is_moved_to_where_both_views_have_it(axis: int) -> None:
    """P50: columns and rows are whole pixels, 22 mm of the room; both views know better."""
    truth, pose = standing(), standing()
    pose[axis] += 0.03
    assert settled(
        pose, pose, BODY, silhouettes_of(RIG, seen(truth)), votes(False)
    ) == pytest.approx(truth)


def test_what_fits_is_left_alone() -> None:
    """A pose that both silhouettes agree with stays, bit for bit."""
    pose = standing(r_shoulder_z=120.0, l_shoulder_x=40.0, r_hip_x=30.0)
    found = settled(pose, standing(), BODY, silhouettes_of(RIG, seen(pose)), votes(False))
    assert np.array_equal(found, pose)


@pytest.mark.parametrize(("bend_deg", "bow_deg"), [(30.0, 10.0), (50.0, 30.0)])
def test_a_squat_is_found_from_straight_legs(bend_deg: float, bow_deg: float) -> None:
    """P34: knees bent twice as far as the hips, so the feet stay; L1: from no idea of it."""
    legs = {f"{side}_hip_x": bend_deg + bow_deg for side in "rl"}
    legs |= {f"{side}_knee_x": -2 * bend_deg for side in "rl"}
    truth = standing(torso_x=bow_deg, **legs)
    truth[1] -= 2 * 0.49 * (1.0 - np.cos(np.radians(bend_deg)))  # thigh and shank: 0.46, 0.52
    found = settled(standing(), standing(), BODY, silhouettes_of(RIG, seen(truth)), votes(False))
    assert found == pytest.approx(truth, abs=1e-9)


def test_only_a_fitted_body_is_turned_joint_by_joint() -> None:
    """A measured body has no feet and would bend to cover them; what was fitted may turn."""
    truth = standing(r_hip_x=24.0, r_knee_x=-30.0)
    start = standing(r_hip_x=10.0, r_knee_x=-8.0)
    turned = settled(start, start, BODY, silhouettes_of(RIG, seen(truth)), votes(True))
    kept = settled(start, start, BODY, silhouettes_of(RIG, seen(truth)), votes(False))
    hip, knee = POSE_INDEX["r_hip_x"], POSE_INDEX["r_knee_x"]
    assert turned[hip] == pytest.approx(24.0, abs=6.0)
    assert turned[knee] == pytest.approx(-30.0, abs=9.0)
    assert kept[[hip, knee]] == pytest.approx(start[[hip, knee]])


def test_no_knee_is_turned_the_wrong_way() -> None:
    """P35: knees bend backwards."""
    poses = turned((("r_hip_x", 10.0), ("r_knee_x", 16.0)), 1.0, standing(), standing())
    assert len(poses) == 25
    assert (poses[:, POSE_INDEX["r_knee_x"]] <= 0.0).all()
    assert poses[0] == pytest.approx(standing())
