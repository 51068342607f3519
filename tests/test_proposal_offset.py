"""Proposals that stand beside the rays as a whole, held against bodies moved by so much."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_proposal_residual import BODY_M, STATURE_M, rays_to

from common.body.body import Vector
from integrator.landmarks import proposal_offset
from integrator.landmarks.joint_mixture import SHOWN
from integrator.landmarks.landmark_rays import Rays
from integrator.landmarks.proposal_offset import (
    EMA_WEIGHT,
    LOOSELY,
    OUTLYING,
    ROUNDS,
    SURELY,
    USUAL,
)

Joints = np.ndarray
FORWARD_M = np.array([0.0, 0.0, 0.2])


def after(instants: int, proposed_m: Joints, rays: Rays) -> tuple[Vector, Joints]:
    """What is known, and the proposal moved, after so many equal instants."""
    known: Vector | None = None
    for _ in range(instants):
        known, moved_m = proposal_offset.step(known, proposed_m, rays.confidence, rays, STATURE_M)
    assert known is not None
    return known, moved_m


def turned(joints_m: Joints, by: float) -> Joints:
    """The body turned about the vertical through its middle."""
    middle_m = joints_m.mean(axis=0)
    spin = [[math.cos(by), 0, math.sin(by)], [0, 1, 0], [-math.sin(by), 0, math.cos(by)]]
    found: Joints = middle_m + (joints_m - middle_m) @ np.array(spin).T
    return found


def test_a_proposal_on_its_rays_stays() -> None:
    known, moved_m = after(9, BODY_M, rays_to(BODY_M))
    assert known == pytest.approx(np.zeros(4), abs=1e-9)
    assert np.array_equal(moved_m, BODY_M)


def test_one_that_stands_two_decimetres_behind_comes_back_but_for_what_is_usual() -> None:
    known, moved_m = after(30, BODY_M - FORWARD_M, rays_to(BODY_M))
    assert known[:3] == pytest.approx(FORWARD_M, abs=0.005)
    left_m = np.linalg.norm(moved_m - BODY_M, axis=1)
    assert left_m == pytest.approx(np.full(12, SURELY * USUAL[2]), abs=0.005)


def test_one_that_is_turned_is_turned_back_likewise() -> None:
    known, moved_m = after(30, turned(BODY_M, math.radians(20.0)), rays_to(BODY_M))
    assert math.degrees(known[3]) == pytest.approx(-20.0, abs=1.5)
    off_m = np.linalg.norm(moved_m - BODY_M, axis=1)
    assert off_m.max() < 0.4 * np.linalg.norm(turned(BODY_M, 0.35) - BODY_M, axis=1).max()


@given(st.lists(st.floats(-0.012, 0.012), min_size=3, max_size=3))
def test_what_landmarks_are_off_together_moves_nothing(by_m: list[float]) -> None:
    _, moved_m = after(30, BODY_M + by_m, rays_to(BODY_M))
    assert np.array_equal(moved_m, BODY_M + by_m)


def test_one_view_alone_does_not_tell_and_one_instant_proves_little() -> None:
    alone = rays_to(BODY_M, (0.8, 0.0))
    assert np.array_equal(after(30, BODY_M - FORWARD_M, alone)[1], BODY_M - FORWARD_M)
    once = after(1, BODY_M - FORWARD_M, rays_to(BODY_M))[1]
    assert np.linalg.norm(once - BODY_M, axis=1).min() > 0.14


def test_three_joints_that_speak_of_somebody_else_do_not_carry_the_body_away() -> None:
    wrong_m = BODY_M.copy()
    wrong_m[:3] += (0.0, 0.6, 0.0)
    _, moved_m = after(30, BODY_M, rays_to(wrong_m))
    assert np.linalg.norm(moved_m - BODY_M, axis=1).max() < 0.03


@pytest.mark.parametrize("seed", range(4))
def test_an_instant_is_least_squares_weighted_by_how_far_rays_are_outlying(seed: int) -> None:
    """One joint at a time, by the projection beside its ray."""
    rng = np.random.default_rng(seed)
    rays = rays_to(BODY_M, (0.9, 0.6))
    proposed_m = BODY_M + rng.normal(0.0, 0.05, 3) + rng.normal(0.0, 0.02, (12, 3))
    away_m = proposed_m - proposed_m.mean(axis=0)
    found: np.ndarray = np.zeros(4)
    for _ in range(ROUNDS):
        normal, right = LOOSELY.copy(), np.zeros(4)
        for view in range(2):
            for joint in range(12):
                along, sure = rays.directions[view, joint], rays.confidence[view, joint]
                across = np.eye(3) - np.outer(along, along)
                x, _, z = away_m[joint]
                moves = across @ np.column_stack([np.eye(3), [z, 0.0, -x]])
                off_m = across @ (proposed_m[joint] - rays.centres_m[view])
                spread_m = STATURE_M * (SHOWN.right + SHOWN.unsure * (1.0 - sure))
                square = float(np.square(off_m + moves @ found).sum())
                weight = sure / (spread_m**2 + square / OUTLYING**2)
                normal += weight * moves.T @ moves
                right -= weight * moves.T @ off_m
        found = np.linalg.solve(normal, right)
    known, moved_m = proposal_offset.step(None, proposed_m, rays.confidence, rays, STATURE_M)
    assert known == pytest.approx(EMA_WEIGHT * found)
    off = np.linalg.norm(known / USUAL)
    turn_x = np.column_stack([away_m[:, 2], np.zeros(12), -away_m[:, 0]])
    back = known * max(0.0, 1.0 - SURELY / float(off))
    assert moved_m == pytest.approx(proposed_m + back[:3] + back[3] * turn_x)
    later, _ = proposal_offset.step(known, proposed_m, rays.confidence, rays, STATURE_M)
    assert later == pytest.approx(EMA_WEIGHT * found + (1.0 - EMA_WEIGHT) * known)


def test_one_view_alone_does_not_say_how_far_a_proposal_is_displaced() -> None:
    rays = rays_to(BODY_M, (0.9, 0.0))
    known, moved_m = after(3, BODY_M + FORWARD_M, rays)
    assert not known.any()
    assert np.array_equal(moved_m, BODY_M + FORWARD_M)
