"""Turns in space, held against scipy's."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from animator.turns import arc, euler_zxy_deg, frame_of, quaternions, slerp, times, turned

seeds = st.integers(0, 10_000)


def rotations(seed: int, count: int = 5) -> Rotation:
    return Rotation.random(count, random_state=seed)


def ours(rotation: Rotation) -> np.ndarray:
    return rotation.as_quat(scalar_first=True)


@given(seeds)
def test_turns_are_joined_and_applied_as_matrices_are(seed: int) -> None:
    first, second = rotations(seed), rotations(seed + 1)
    vectors = np.random.default_rng(seed).normal(size=(5, 3))
    assert np.allclose(turned(ours(first), vectors), first.apply(vectors))
    joined = Rotation.from_quat(times(ours(first), ours(second)), scalar_first=True)
    assert np.allclose(joined.as_matrix(), (first * second).as_matrix())


@given(seeds)
def test_matrices_become_the_quaternions_that_turn_alike(seed: int) -> None:
    matrices = rotations(seed).as_matrix()
    again = Rotation.from_quat(quaternions(matrices), scalar_first=True).as_matrix()
    assert np.allclose(again, matrices, rtol=0.0, atol=1e-14)


@given(seeds)
def test_the_shortest_arc_meets_its_end_and_twists_nothing(seed: int) -> None:
    start, *ends = np.random.default_rng(seed).normal(size=(6, 3))
    turns = Rotation.from_quat(arc(start, np.array(ends)), scalar_first=True)
    unit = np.array(ends) / np.linalg.norm(ends, axis=1)[:, None]
    assert np.allclose(turns.apply(start / np.linalg.norm(start)), unit)
    angle = np.arccos(np.clip(unit @ start / np.linalg.norm(start), -1, 1))
    assert np.allclose(turns.magnitude(), angle, atol=1e-6)


def test_to_the_opposite_direction_leads_half_a_turn() -> None:
    turns = arc(np.array([0.0, 1.0, 0.0]), np.array([[0.0, -2.0, 0.0]]))
    assert np.allclose(turned(turns, np.array([[0.0, 1.0, 0.0]])), [[0.0, -1.0, 0.0]])


@given(seeds)
def test_of_two_directions_the_one_that_is_kept_is_met(seed: int) -> None:
    up, across = np.random.default_rng(seed).normal(size=(2, 4, 3))
    x, y = np.tile((1.0, 0.0, 0.0), (4, 1)), np.tile((0.0, 1.0, 0.0), (4, 1))
    met = turned(frame_of(up, across), y)
    assert np.allclose(met, up / np.linalg.norm(up, axis=1)[:, None])
    met = turned(frame_of(up, across, keep="across"), x)
    assert np.allclose(met, across / np.linalg.norm(across, axis=1)[:, None])


@given(seeds, st.floats(0.0, 1.0))
def test_turns_between_two_go_evenly_the_shorter_way(seed: int, share: float) -> None:
    """T23: shortest arc, also where a quaternion and its negative stand for one turn."""
    first, second = rotations(seed), rotations(seed + 1)
    way = first.inv() * second
    expected = first * Rotation.from_rotvec(share * way.as_rotvec())
    for sign in (1.0, -1.0):
        found = slerp(ours(first), sign * ours(second), np.full(5, share))
        again = Rotation.from_quat(found, scalar_first=True)
        assert np.allclose(again.as_matrix(), expected.as_matrix(), atol=1e-6)


@given(seeds)
def test_euler_angles_mean_the_turn_they_are_of(seed: int) -> None:
    rotation = rotations(seed)
    angles = euler_zxy_deg(ours(rotation)[:, None])[:, 0]
    again = Rotation.from_euler("ZXY", angles, degrees=True)
    assert np.allclose(again.as_matrix(), rotation.as_matrix(), atol=1e-6)


def test_euler_angles_of_an_arm_that_goes_round_do_not_jump() -> None:
    """Twice round about x, through the tilt of 90 degrees where both triples meet."""
    degrees = np.arange(0.0, 720.0, 4.0) + 1.0
    turns = ours(Rotation.from_euler("ZXY", [[20.0, each, 10.0] for each in degrees], degrees=True))
    angles = euler_zxy_deg(turns[:, None])[:, 0]
    assert np.abs(np.diff(angles, axis=0)).max() < 4.0 + 1e-6
