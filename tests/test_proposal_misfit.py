"""How far proposals are off what is shown, held against bodies that were moved by so much."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from integrator.landmarks import proposal_misfit
from integrator.landmarks.landmark_rays import Rays
from integrator.landmarks.proposal_misfit import FARTHEST, LATELY, USUAL, WIDER, Misfit

STATURE_M = 2.0
UP_M = np.array([0.0, 1.0, 0.0])
BODY_M = np.random.default_rng(3).uniform(-0.5, 0.5, (12, 3)) + UP_M
CENTRES_M = np.array([[0.0, 1.0, 4.0], [-4.0, 1.0, 0.0]])


def rays_to(joints_m: np.ndarray, sure: tuple[float, float] = (0.8, 0.8)) -> Rays:
    along = joints_m[None] - CENTRES_M[:, None]
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    confidence = np.repeat(np.array(sure)[:, None], 12, axis=1)
    return Rays(CENTRES_M, along, confidence, np.stack([np.eye(3)] * 2), (0.0, 0.0), (0.0, 0.0))


def after(
    instants: int, proposed_m: np.ndarray, rays: Rays, before: Misfit | None = None
) -> Misfit:
    found = before
    for _ in range(instants):
        found = proposal_misfit.step(found, proposed_m, rays, STATURE_M)
    assert found is not None
    return found


def test_a_proposal_on_its_rays_is_not_off_and_is_not_widened() -> None:
    found = after(3, BODY_M, rays_to(BODY_M))
    assert found.off == pytest.approx(0.0, abs=1e-9)
    assert proposal_misfit.wider_m(found, STATURE_M) == 0.0


def test_one_who_is_raised_is_off_by_that_in_statures() -> None:
    level_m = BODY_M * (1.0, 0.0, 1.0) + UP_M  # as high as the cameras
    found = after(1, level_m + 0.3 * UP_M, rays_to(level_m))
    assert found.off == pytest.approx(0.15)
    assert proposal_misfit.wider_m(found, STATURE_M) == pytest.approx(
        WIDER * (0.15 - USUAL) * STATURE_M
    )


def test_one_whose_sides_a_view_exchanged_is_not_off() -> None:
    exchanged_m = BODY_M.reshape(6, 2, 3)[:, ::-1].reshape(12, 3)
    assert after(1, exchanged_m, rays_to(BODY_M)).off == pytest.approx(0.0, abs=1e-9)


def test_a_depth_that_one_view_cannot_see_is_not_held_against_a_proposal() -> None:
    away_m = BODY_M - CENTRES_M[0]
    found = after(1, CENTRES_M[0] + 1.3 * away_m, rays_to(BODY_M, (0.8, 0.0)))
    assert found.off == pytest.approx(0.0, abs=1e-6)


def test_nothing_shown_changes_nothing() -> None:
    before = after(2, BODY_M + 0.1, rays_to(BODY_M))
    assert after(5, BODY_M + 3.0, rays_to(BODY_M, (0.0, 0.0)), before) == before


@given(st.floats(0.0, 9.0))
def test_no_proposal_is_farther_off_than_a_landmark_may_say(far_m: float) -> None:
    assert after(2, BODY_M + far_m, rays_to(BODY_M)).off <= FARTHEST + 1e-9


def test_what_was_long_ago_is_forgotten_as_the_sum_of_a_geometric_row_says() -> None:
    off = after(9, BODY_M + 9.0, rays_to(BODY_M, (1.0, 1.0)))
    found = after(7, BODY_M, rays_to(BODY_M, (1.0, 1.0)), off)
    kept, weight = (1 - LATELY) ** 7, 1 - (1 - LATELY) ** 16
    assert found.off == pytest.approx(FARTHEST * np.sqrt(kept * (1 - (1 - LATELY) ** 9) / weight))
