"""How far proposals are off what is shown, held against bodies that were moved by so much."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from integrator.landmarks import proposal_residual
from integrator.landmarks.landmark_rays import Rays
from integrator.landmarks.proposal_residual import (
    EMA_WEIGHT,
    FARTHEST,
    ODDS_EXPONENT,
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
        found = proposal_residual.step(found, proposed_m, rays, STATURE_M)
    return math.sqrt(found.whole)


def test_a_proposal_on_its_rays_is_not_off_and_is_not_widened() -> None:
    assert after(3, BODY_M, rays_to(BODY_M)) == pytest.approx(0.0, abs=1e-9)
    never = Misfit(0.0, np.zeros(6))
    assert not proposal_residual.wider_m(never, rays_to(BODY_M), STATURE_M).any()


def test_one_who_stays_raised_is_off_by_that_in_statures() -> None:
    level_m = BODY_M * (1.0, 0.0, 1.0) + UP_M  # as high as the cameras
    assert after(99, level_m + 0.3 * UP_M, rays_to(level_m)) == pytest.approx(0.15)
    misfit = Misfit(0.15**2, np.zeros(6))
    found_m = proposal_residual.wider_m(misfit, rays_to(level_m), STATURE_M)
    assert found_m == pytest.approx(np.full(12, WIDER * (0.15 - USUAL) * STATURE_M))


def test_a_proposal_is_doubted_by_how_far_it_was_off_lately_and_once_it_is_turned() -> None:
    near, off, far = (Misfit(each**2, np.zeros(6)) for each in (0.02, 0.06, 0.12))
    assert proposal_residual.doubt(near, turned=False) == 1.0
    doubts = [proposal_residual.doubt(misfit, turned=False) for misfit in (off, far)]
    assert doubts[1] / doubts[0] == pytest.approx(2.0**ODDS_EXPONENT)
    assert proposal_residual.doubt(off, turned=True) == pytest.approx(TURNED * doubts[0])


def test_wrists_that_are_off_alone_are_doubted_by_one_view_and_all_alike_by_two() -> None:
    level_m = BODY_M * (1.0, 0.0, 1.0) + UP_M
    wrong_m = level_m.copy()
    wrong_m[4:6] += 0.4 * UP_M  # 0.2 statures
    alone = rays_to(level_m, (0.8, 0.0))
    misfit = None
    for _ in range(99):
        misfit = proposal_residual.step(misfit, wrong_m, alone, STATURE_M)
    assert misfit is not None
    assert np.sqrt(misfit.pairs) == pytest.approx([0.0, 0.0, 0.2, 0.0, 0.0, 0.0])
    all_alike_m = WIDER * (0.2 / math.sqrt(6) - USUAL) * STATURE_M
    found_m = proposal_residual.wider_m(misfit, alone, STATURE_M)
    assert found_m[4:6] == pytest.approx(WIDER * (0.2 - USUAL) * STATURE_M)
    assert np.delete(found_m, [4, 5]) == pytest.approx(all_alike_m)
    found_m = proposal_residual.wider_m(misfit, rays_to(level_m), STATURE_M)
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
    assert found == pytest.approx(0.2 * (1.0 - EMA_WEIGHT) ** 3.5)


def test_an_instant_is_a_mean_weighted_by_how_sure_its_landmarks_are() -> None:
    """Joint by joint; each pair of a view by its own sides or exchanged, whichever is nearer."""
    rng = np.random.default_rng(2)
    rays = rays_to(BODY_M)
    sure = rng.uniform(0.0, 0.9, (2, 12))
    proposed_m = BODY_M + rng.normal(0.0, 0.2, (12, 3))
    proposed_m[4] += 3.0
    rays = rays._replace(confidence=sure)
    squares, weights = np.zeros(6), np.zeros(6)
    for view in range(2):
        for pair in range(6):
            at = [2 * pair, 2 * pair + 1]
            offs = []
            for ends in (at, at[::-1]):
                away = proposed_m[at] - CENTRES_M[view]
                cross = np.cross(away, rays.directions[view, ends])
                offs.append(np.linalg.norm(cross, axis=1) / STATURE_M)
            nearer = min(offs, key=sum)
            squares[pair] += (sure[view, at] * np.minimum(nearer, FARTHEST) ** 2).sum()
            weights[pair] += sure[view, at].sum()
    before = Misfit(0.002, rng.uniform(0.0, 0.01, 6))
    found = proposal_residual.step(before, proposed_m, rays, STATURE_M)
    share = EMA_WEIGHT * min(1.0, weights.sum() / 12)
    mean = squares.sum() / weights.sum()
    assert found.whole == pytest.approx(share * mean + (1 - share) * before.whole)
    shares = EMA_WEIGHT * np.minimum(1.0, weights / 2)
    assert found.pairs == pytest.approx(shares * squares / weights + (1 - shares) * before.pairs)
    first = proposal_residual.step(None, proposed_m, rays, STATURE_M)
    assert first.whole == pytest.approx(share * mean)


def test_pairs_are_doubted_one_by_one_where_one_view_alone_has_landmarks() -> None:
    pairs = np.array([0.0, 0.1, 0.2, 0.0, 0.07, 0.0]) ** 2
    misfit = Misfit(0.08**2, pairs)
    by_whole, by_pair = (
        proposal_residual.wider_m(misfit, rays_to(BODY_M, sure), STATURE_M)
        for sure in ((0.8, 0.8), (0.8, 0.0))
    )
    assert by_whole == pytest.approx(np.full(12, WIDER * (0.08 - USUAL) * STATURE_M))
    worse = np.repeat(np.maximum(np.sqrt(pairs), 0.08), 2)
    assert by_pair == pytest.approx(WIDER * (worse - USUAL) * STATURE_M)
