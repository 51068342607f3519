"""How far proposals are off what is shown, held against bodies that were moved by so much."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from integrator.landmarks import proposal_misfit
from integrator.landmarks.landmark_rays import Rays
from integrator.landmarks.proposal_misfit import (
    FARTHEST,
    LATELY,
    STEEPLY,
    TURNED,
    USUAL,
    WIDER,
    Misfit,
)

STATURE_M = 2.0
UP_M = np.array([0.0, 1.0, 0.0])
BODY_M = np.random.default_rng(3).uniform(-0.5, 0.5, (12, 3)) + UP_M
CENTRES_M = np.array([[0.0, 1.0, 4.0], [-4.0, 1.0, 0.0]])


def rays_to(joints_m: np.ndarray, sure: tuple[float, float] = (0.8, 0.8)) -> Rays:
    along = joints_m[None] - CENTRES_M[:, None]
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    confidence = np.repeat(np.array(sure)[:, None], 12, axis=1)
    nowhere = np.zeros_like(confidence)
    turns = np.stack([np.eye(3)] * 2)
    return Rays(CENTRES_M, along, confidence, along, nowhere, turns, (0.0, 0.0), (0.0, 0.0))


def after(instants: int, proposed_m: np.ndarray, rays: Rays, before: float = 0.0) -> float:
    """How far a proposal has been off after so many equal instants, statures."""
    found = Misfit(before**2, np.full(6, before**2))
    for _ in range(instants):
        found = proposal_misfit.step(found, proposed_m, rays, STATURE_M)
    return math.sqrt(found.whole)


def test_a_proposal_on_its_rays_is_not_off_and_is_not_widened() -> None:
    assert after(3, BODY_M, rays_to(BODY_M)) == pytest.approx(0.0, abs=1e-9)
    never = Misfit(0.0, np.zeros(6))
    assert not proposal_misfit.wider_m(never, rays_to(BODY_M), STATURE_M).any()


def test_one_who_stays_raised_is_off_by_that_in_statures() -> None:
    level_m = BODY_M * (1.0, 0.0, 1.0) + UP_M  # as high as the cameras
    assert after(99, level_m + 0.3 * UP_M, rays_to(level_m)) == pytest.approx(0.15)
    misfit = Misfit(0.15**2, np.zeros(6))
    found_m = proposal_misfit.wider_m(misfit, rays_to(level_m), STATURE_M)
    assert found_m == pytest.approx(np.full(12, WIDER * (0.15 - USUAL) * STATURE_M))


def test_a_proposal_is_doubted_by_how_far_it_was_off_lately_and_once_it_is_turned() -> None:
    near, off, far = (Misfit(each**2, np.zeros(6)) for each in (0.02, 0.06, 0.12))
    assert proposal_misfit.doubt(near, turned=False) == 1.0
    doubts = [proposal_misfit.doubt(misfit, turned=False) for misfit in (off, far)]
    assert doubts[1] / doubts[0] == pytest.approx(2.0**STEEPLY)
    assert proposal_misfit.doubt(off, turned=True) == pytest.approx(TURNED * doubts[0])


def test_wrists_that_are_off_alone_are_doubted_by_one_view_and_all_alike_by_two() -> None:
    level_m = BODY_M * (1.0, 0.0, 1.0) + UP_M
    wrong_m = level_m.copy()
    wrong_m[4:6] += 0.4 * UP_M  # 0.2 statures
    alone = rays_to(level_m, (0.8, 0.0))
    misfit = None
    for _ in range(99):
        misfit = proposal_misfit.step(misfit, wrong_m, alone, STATURE_M)
    assert misfit is not None
    assert np.sqrt(misfit.pairs) == pytest.approx([0.0, 0.0, 0.2, 0.0, 0.0, 0.0])
    all_alike_m = WIDER * (0.2 / math.sqrt(6) - USUAL) * STATURE_M
    found_m = proposal_misfit.wider_m(misfit, alone, STATURE_M)
    assert found_m[4:6] == pytest.approx(WIDER * (0.2 - USUAL) * STATURE_M)
    assert np.delete(found_m, [4, 5]) == pytest.approx(all_alike_m)
    found_m = proposal_misfit.wider_m(misfit, rays_to(level_m), STATURE_M)
    assert found_m == pytest.approx(all_alike_m)


def test_one_whose_sides_a_view_exchanged_is_not_off() -> None:
    exchanged_m = BODY_M.reshape(6, 2, 3)[:, ::-1].reshape(12, 3)
    assert after(9, exchanged_m, rays_to(BODY_M)) == pytest.approx(0.0, abs=1e-9)


def test_a_depth_that_one_view_cannot_see_is_not_held_against_a_proposal() -> None:
    away_m = BODY_M - CENTRES_M[0]
    found = after(9, CENTRES_M[0] + 1.3 * away_m, rays_to(BODY_M, (0.8, 0.0)))
    assert found == pytest.approx(0.0, abs=1e-6)


def test_nothing_shown_changes_nothing() -> None:
    assert after(5, BODY_M + 3.0, rays_to(BODY_M, (0.0, 0.0)), before=0.1) == pytest.approx(0.1)


@given(st.floats(0.0, 9.0))
def test_no_proposal_is_farther_off_than_a_landmark_may_say(far_m: float) -> None:
    assert after(20, BODY_M + far_m, rays_to(BODY_M)) <= FARTHEST + 1e-9


def test_what_was_is_forgotten_by_the_same_share_each_instant() -> None:
    found = after(7, BODY_M, rays_to(BODY_M, (1.0, 1.0)), before=0.2)
    assert found == pytest.approx(0.2 * (1.0 - LATELY) ** 3.5)
