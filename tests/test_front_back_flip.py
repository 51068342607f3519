"""Whether a proposal has front for back, by what views say of where somebody faces."""

import math

import numpy as np
import pytest
from test_proposal_residual import BODY_M, rays_to

from integrator.landmarks.front_back_flip import (
    ANEW,
    FLIP_THRESHOLD,
    RARELY,
    SHARPER,
    TRUST,
    UNIFORM_FLOOR,
    UNTOLD,
    WIDE_DEG,
    confused,
    contradicted,
    faced,
    step,
    yaw_deg,
)
from integrator.landmarks.landmark_rays import Rays
from integrator.proposal.network_weights import JOINTS


def facing(deg: float, lean_deg: float = 0.0) -> np.ndarray:
    """Twelve joints of a trunk that faces so before a camera with the world's axes (y down)."""
    a, b = math.radians(deg), math.radians(lean_deg)
    joints_m = np.zeros((12, 3))
    for i, name in enumerate(JOINTS):
        side = 0.2 if name[0] == "l" else -0.2
        across = side * np.array([math.cos(a), 0.0, math.sin(a)])
        high = 0.5 if name[2:] in ("shoulder", "elbow", "wrist") else 0.0
        joints_m[i] = across - np.array([0.0, high, 0.0])
    roll = [[math.cos(b), -math.sin(b), 0.0], [math.sin(b), math.cos(b), 0.0], [0.0, 0.0, 1.0]]
    return np.asarray(joints_m @ np.array(roll).T)


@pytest.mark.parametrize("deg", [-170.0, -100.0, -30.0, 0.0, 45.0, 90.0, 135.0])
def test_who_stands_upright_faces_where_shoulders_and_hips_say(deg: float) -> None:
    """0: the left side is to the right of the picture, as of who faces the camera."""
    assert yaw_deg(np.eye(3), facing(deg)) == pytest.approx(deg)
    quarter = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    assert yaw_deg(quarter, facing(deg) @ quarter) == pytest.approx(deg)


def test_hips_and_shoulders_that_are_twisted_against_each_other_face_between() -> None:
    twisted = facing(20.0)
    twisted[6:] = facing(60.0)[6:]
    assert yaw_deg(np.eye(3), twisted) == pytest.approx(40.0)


def test_who_lies_across_the_picture_faces_as_if_they_stood() -> None:
    for deg in (-40.0, 0.0, 40.0):
        assert yaw_deg(np.eye(3), facing(deg, lean_deg=80.0)) == pytest.approx(deg, abs=3.0)


def test_how_often_a_view_takes_front_for_back_falls_with_how_sure_it_is() -> None:
    assert confused(0.0) == UNTOLD
    assert confused(0.5) == pytest.approx(0.5)
    assert confused(0.2) == 0.5
    odds = 0.8 / 0.2
    assert confused(0.8) == pytest.approx(1.0 / (1.0 + odds**SHARPER))
    assert confused(1.0) < 1e-6


def told(*facings: tuple[float, float]) -> Rays:
    degs, sures = zip(*facings, strict=True)
    return rays_to(BODY_M)._replace(facing_deg=degs, facing_confidence=sures)


def expected(before: float, joints_m: np.ndarray, rays: Rays) -> float:
    """The same by probabilities: a hidden Markov model of two states."""

    def near(off_deg: float) -> float:
        off_deg = math.remainder(off_deg, 360.0)
        return math.exp(-(off_deg**2) / (2 * WIDE_DEG**2))

    def says(said_deg: float, deg: float, wrong: float) -> float:
        told = (1 - wrong) * near(said_deg - deg) + wrong * near(said_deg + deg - 180.0)
        return told + UNIFORM_FLOOR

    is_so = before + ANEW * (RARELY - before)
    is_not = 1.0 - is_so
    for view, (said_deg, sure) in enumerate(
        zip(rays.facing_deg, rays.facing_confidence, strict=True)
    ):
        if sure > 0.0:
            deg = yaw_deg(rays.rotations[view], joints_m)
            is_so *= says(said_deg, deg + 180.0, confused(sure)) ** TRUST
            is_not *= says(said_deg, deg, confused(sure)) ** TRUST
    return is_so / (is_so + is_not)


@pytest.mark.parametrize("seed", range(6))
def test_an_instant_is_one_step_of_a_hidden_markov_model(seed: int) -> None:
    rng = np.random.default_rng(seed)
    degs, sures = rng.uniform(-180.0, 180.0, 2), rng.uniform(0.4, 0.95, 2) * [1.0, seed % 3]
    rays = told(*zip(degs.tolist(), np.minimum(sures, 0.95).tolist(), strict=True))
    before = float(rng.uniform(0.01, 0.9))
    joints_m = facing(float(rng.uniform(-90.0, 90.0)))
    found, _ = step((before, False), joints_m, rays)
    assert found == pytest.approx(expected(before, joints_m, rays))
    assert step(None, joints_m, rays)[0] == pytest.approx(expected(RARELY, joints_m, rays))


def test_a_proposal_is_turned_once_that_is_sure_and_until_it_is_as_surely_not_so() -> None:
    nothing = told((0.0, 0.0), (0.0, 0.0))
    unsure = (0.5 - ANEW * RARELY) / (1 - ANEW)
    between = 0.5
    assert 1.0 - FLIP_THRESHOLD < between < FLIP_THRESHOLD
    for was in (True, False):
        now, turned = step((unsure, was), BODY_M, nothing)
        assert now == pytest.approx(between)
        assert turned == was
    assert step((0.999, False), BODY_M, nothing)[1]
    assert not step((0.1, True), BODY_M, nothing)[1]


def quartered(first: tuple[float, float], second: tuple[float, float]) -> Rays:
    """Two views at a right angle: the second has the first one's x as its depth."""
    quarter = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    return told(first, second)._replace(rotations=np.stack([np.eye(3), quarter]))


def test_a_pose_whose_facing_both_views_deny_loses_its_odds() -> None:
    """The mirror image of -37 degrees across the middle of both views is -127: a quarter turn."""
    rays = quartered((-20.0, 0.92), (42.0, 0.95))
    true, mirrored = facing(-37.0), facing(-127.0)
    assert yaw_deg(rays.rotations[1], true) == pytest.approx(53.0)
    assert contradicted(true, rays) == 1.0
    assert contradicted(mirrored, rays) > 50.0
    unsure = quartered((-20.0, 0.0), (42.0, 0.0))
    assert contradicted(mirrored, unsure) == 1.0


def test_a_facing_that_is_as_likely_as_any_speaks_neither_for_nor_against() -> None:
    """By Bayes: the density of a normal facing against that of any, 1 / 360 a degree."""
    for off_deg in (0.0, 40.0, 70.0, 100.0):
        said, pose = told((0.0, 0.99)), facing(off_deg)
        normal = math.exp(-0.5 * (off_deg / WIDE_DEG) ** 2)
        density = (normal + UNIFORM_FLOOR) / (math.sqrt(2.0 * math.pi) * WIDE_DEG)
        due = max(1.0, 1.0 / 360.0 / density)
        assert contradicted(pose, said) == pytest.approx(due, rel=0.02)


@pytest.mark.parametrize("lean_deg", [0.0, 50.0])
def test_the_facing_of_each_way_of_exchanging_is_that_of_its_own_joints(lean_deg: float) -> None:
    """Arms of one way and legs of another face between; a view that exchanged both is mirrored."""
    rays = quartered((-20.0, 0.92), (42.0, 0.6))
    ways = np.array([(0, 0), (1, 0), (0, 1)])
    bodies = np.stack([facing(deg, lean_deg) for deg in (-37.0, -80.0, 20.0)], axis=1)
    found = faced(bodies, ways, rays)
    assert found.shape == (3, 3)
    for arms in range(3):
        for legs in range(3):
            body = np.concatenate([bodies[:6, arms], bodies[6:, legs]])
            due = 0.0
            for view, wrong in enumerate(map(confused, rays.facing_confidence)):
                deg, said_deg = yaw_deg(rays.rotations[view], body), rays.facing_deg[view]
                deg = 180.0 - deg if ways[arms, view] and ways[legs, view] else deg
                off = [math.remainder(said_deg - each, 360.0) for each in (deg, 180.0 - deg)]
                near = [math.exp(-0.5 * (each / WIDE_DEG) ** 2) for each in off]
                due += math.log((1 - wrong) * near[0] + wrong * near[1] + UNIFORM_FLOOR)
            assert found[arms, legs] == pytest.approx(due, abs=0.05 if lean_deg else 1e-9)


def test_views_without_a_facing_tell_no_exchange() -> None:
    ways = np.array([(0, 0), (1, 1)])
    bodies = np.stack([facing(0.0), facing(180.0)], axis=1)
    assert not faced(bodies, ways, quartered((0.0, 0.0), (90.0, 0.0))).any()
