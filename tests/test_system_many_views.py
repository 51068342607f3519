"""The fusion of three views and more, held against that of two and against a known body."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from staging import PERSON, standing

from common.body.kinematics import joints
from common.body.proportions import body_vector
from integrator.landmarks import landmark_fusion, left_right_swap
from integrator.landmarks.landmark_fusion import Fused
from integrator.landmarks.landmark_rays import AT, Rays
from integrator.landmarks.left_right_swap import Exchanged

RNG = np.random.default_rng(20261128)
STRIDE = standing(l_hip_x=40.0, l_knee_x=-60.0, r_shoulder_x=50.0)
TRUE_M = np.asarray(joints(body_vector(PERSON), STRIDE))[AT]
CENTRES_M = np.array(
    [[0.0, 1.0, 4.0], [-4.0, 1.2, 0.0], [2.8, 1.1, 2.8], [-2.8, 0.9, -2.8], [3.9, 1.0, -0.3]]
)
SURE = 0.85
LEGS = slice(6, 12)


def rays(views: int, sure: float = SURE) -> Rays:
    """What so many views show of the true joints; they do not tell which way the person faces."""
    centres_m = CENTRES_M[:views]
    away = TRUE_M - centres_m[:, None]
    directions = away / np.linalg.norm(away, axis=2, keepdims=True)
    confidence = np.full((views, 12), sure)
    rotations = np.broadcast_to(np.eye(3), (views, 3, 3))
    nothing = (0.0,) * views
    return Rays(
        centres_m,
        directions,
        confidence,
        directions.copy(),
        np.zeros((views, 12)),
        rotations,
        nothing,
        nothing,
    )


def with_legs_exchanged(seen: Rays, view: int) -> Rays:
    """The same, but one view takes the left leg for the right one."""
    directions = seen.directions.copy()
    directions[view, LEGS] = directions[view, [7, 6, 9, 8, 11, 10]]
    return seen._replace(directions=directions)


def taken(seen: Rays, views: list[int]) -> Rays:
    """Of some views alone, in this order."""
    return seen._replace(
        centres_m=seen.centres_m[views],
        directions=seen.directions[views],
        confidence=seen.confidence[views],
        others=seen.others[views],
        others_confidence=seen.others_confidence[views],
        rotations=seen.rotations[views],
        facing_deg=tuple(seen.facing_deg[view] for view in views),
        facing_confidence=tuple(seen.facing_confidence[view] for view in views),
    )


def fused(seen: Rays, proposed_m: np.ndarray, instants: int = 1) -> Fused:
    memory = None
    for _ in range(instants):
        found = landmark_fusion.step(memory, proposed_m, np.full(12, 0.7), seen, 1.75)
        memory = found.memory
    return found


@pytest.mark.slow
@pytest.mark.parametrize("views", [1, 2, 3])
def test_a_view_that_shows_nothing_changes_nothing(views: int) -> None:
    """So the fusion of two views is that of three of which one sees no person."""
    proposed_m = TRUE_M + RNG.normal(0.0, 0.03, TRUE_M.shape)
    seen = rays(views + 1)
    blind = seen._replace(confidence=seen.confidence * (np.arange(views + 1) < views)[:, None])
    expected = fused(taken(seen, list(range(views))), proposed_m)
    found = fused(blind, proposed_m)
    assert found.joints_m == pytest.approx(expected.joints_m, abs=1e-9)
    assert found.confidence == pytest.approx(expected.confidence, abs=1e-9)


@pytest.mark.parametrize("order", list(permutations(range(3)))[1:])
def test_the_order_of_the_views_changes_nothing(order: tuple[int, ...]) -> None:
    proposed_m = TRUE_M + RNG.normal(0.0, 0.03, TRUE_M.shape)
    seen = with_legs_exchanged(rays(3), 1)
    expected, found = fused(seen, proposed_m), fused(taken(seen, list(order)), proposed_m)
    assert found.joints_m == pytest.approx(expected.joints_m, abs=1e-9)
    assert found.exchanged.legs == tuple(expected.exchanged.legs[view] for view in order)


@pytest.mark.parametrize("views", [3, 4, 5])
def test_joints_are_where_the_rays_of_all_views_meet(views: int) -> None:
    """Whatever the proposal says of one of them."""
    proposed_m = TRUE_M.copy()
    proposed_m[0] += (0.2, 0.1, -0.2)
    found = fused(rays(views), proposed_m)
    assert np.linalg.norm(found.joints_m - TRUE_M, axis=1).max() < 0.03
    assert found.confidence[0] > 0.5


def test_more_views_hold_a_joint_more_tightly() -> None:
    sure = [fused(rays(views), TRUE_M).confidence.mean() for views in (2, 3, 4, 5)]
    assert sure == sorted(sure)
    assert sure[-1] > sure[0]


@pytest.mark.parametrize("views", [3, 4, 5])
@pytest.mark.parametrize("view", [0, 1, 2])
def test_of_many_views_the_one_that_exchanges_the_legs_is_found_out(views: int, view: int) -> None:
    found = fused(with_legs_exchanged(rays(views), view), TRUE_M, instants=2)
    assert found.exchanged.arms == (0,) * views
    assert found.exchanged.legs == tuple(int(n == view) for n in range(views))
    assert np.linalg.norm(found.joints_m - TRUE_M, axis=1).max() < 0.03


def test_a_joint_that_one_view_of_three_has_wrong_is_where_the_others_have_it() -> None:
    seen = rays(3)
    away = TRUE_M[2] + (0.0, 0.35, 0.0) - CENTRES_M[2]
    seen.directions[2, 2] = away / np.linalg.norm(away)
    found = fused(seen, TRUE_M + RNG.normal(0.0, 0.02, TRUE_M.shape))
    assert np.linalg.norm(found.joints_m[2] - TRUE_M[2]) < 0.03


@given(
    st.lists(st.floats(-6.0, 6.0), min_size=2, max_size=2),
    st.lists(st.floats(-6.0, 6.0), min_size=2, max_size=2),
    st.floats(0.0, 1.0),
    st.floats(0.001, 0.4),
)
def test_a_view_by_itself_is_the_model_of_one_view(
    arms: list[float], legs: list[float], aside: float, confused: float
) -> None:
    joint, decided = left_right_swap.step(
        None, np.array(arms), np.array(legs), (aside,), (confused,)
    )
    each, alone = left_right_swap.step_each(
        None, np.array([arms]), np.array([legs]), (aside,), (confused,)
    )
    assert (each == joint[None]).all()
    assert alone == decided


def test_three_views_that_say_nothing_of_each_other_are_three_models_of_one() -> None:
    """What is said of each view alone gives the same in the joint model: its marginals."""
    said = RNG.normal(0.0, 2.0, (2, 3, 2))
    aside, confused = (0.1, 0.9, 0.5), (0.01, 0.2, 0.1)
    joint_of = [
        own[0][:, None, None] + own[1][None, :, None] + own[2][None, None, :] for own in said
    ]
    (arms, legs), (arms_each, legs_each) = joint_of, said
    together, decided = left_right_swap.step(None, arms, legs, aside, confused)
    apart, alone = left_right_swap.step_each(None, arms_each, legs_each, aside, confused)
    for _ in range(3):
        assert decided == alone
        for view in range(3):
            others = tuple(axis for axis in range(6) if axis not in (view, 3 + view))
            assert together.sum(axis=others) == pytest.approx(apart[view])
        together, decided = left_right_swap.step(together, arms, legs, aside, confused)
        apart, alone = left_right_swap.step_each(apart, arms_each, legs_each, aside, confused)


def test_of_all_that_views_may_exchange_what_is_said_loudest_is_decided() -> None:
    arms, legs = np.zeros((2, 2, 2)), np.zeros((2, 2, 2))
    arms[0, 1, 0], legs[1, 0, 1] = 30.0, 40.0
    _, decided = left_right_swap.step(None, arms, legs, (0.5,) * 3, (0.1,) * 3)
    assert decided == Exchanged((0, 1, 0), (1, 0, 1))
