"""Turns that lead directions to directions: what they must meet, and what they must not twist."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from animator.turns import arc, arc_axes, axes_of

seeds = st.integers(0, 10_000)


@given(seeds)
def test_the_shortest_arc_meets_its_end_and_twists_nothing(seed: int) -> None:
    start, *ends = np.random.default_rng(seed).normal(size=(6, 3))
    turns = arc(start, np.array(ends))
    unit = np.array(ends) / np.linalg.norm(ends, axis=1)[:, None]
    assert np.allclose(turns.apply(start / np.linalg.norm(start)), unit)
    angle = np.arccos(np.clip(unit @ start / np.linalg.norm(start), -1, 1))
    assert np.allclose(turns.magnitude(), angle, atol=1e-6)


def test_to_the_opposite_direction_leads_half_a_turn() -> None:
    turns = arc(np.array([0.0, 1.0, 0.0]), np.array([[0.0, -2.0, 0.0]]))
    assert np.allclose(turns.apply([0.0, 1.0, 0.0]), [[0.0, -1.0, 0.0]])


@given(seeds)
def test_of_two_directions_the_one_that_is_kept_is_met(seed: int) -> None:
    up, across = np.random.default_rng(seed).normal(size=(2, 4, 3))
    met = axes_of(up, across) @ [0.0, 1.0, 0.0]
    assert np.allclose(met, up / np.linalg.norm(up, axis=1)[:, None])
    met = axes_of(up, across, keep="across") @ [1.0, 0.0, 0.0]
    assert np.allclose(met, across / np.linalg.norm(across, axis=1)[:, None])


@given(seeds)
def test_as_matrices_they_are_the_same_turns(seed: int) -> None:
    start, *ends = np.random.default_rng(seed).normal(size=(6, 3))
    ends[0] = -3.0 * start
    turns = arc(start, np.array(ends))
    assert np.allclose(arc_axes(start, np.array(ends)), turns.as_matrix(), atol=1e-9)
