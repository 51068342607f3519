"""Turns, held against scipy's."""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from synth.anny_people.part_turns import about, between, hanging, raised_deg


def test_a_part_of_a_turn_is_the_slerp() -> None:
    first, second = (Rotation.random(20, random_state=seed) for seed in (1, 2))
    found = between(first.as_matrix(), second.as_matrix(), 0.3)
    for a, b, turn in zip(first, second, found, strict=True):
        due = Slerp([0.0, 1.0], Rotation.concatenate([a, b]))(0.3)
        assert np.allclose(turn, due.as_matrix(), atol=1e-6)


def test_turns_about_an_axis_are_right_handed() -> None:
    axis, angles = np.array([1.0, -2.0, 0.5]), np.array([10.0, -75.0, 140.0])
    unit = axis / np.linalg.norm(axis)
    due = Rotation.from_rotvec(np.radians(angles)[:, None] * unit).as_matrix()
    assert np.allclose(about(axis, angles), due)


def test_a_limb_comes_to_hang_with_its_joint_across() -> None:
    turn = hanging(np.array([0.3, -0.3, 0.1]), np.array([-0.7, -0.7, 0.2]))
    assert np.allclose(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) > 0.0
    down = turn @ np.array([0.3, -0.3, 0.1])
    assert np.allclose(down / np.linalg.norm(down), [0.0, -1.0, 0.0])
    assert (turn @ np.array([-0.7, -0.7, 0.2]))[0] > 0.0


def test_an_arm_held_level_is_raised_by_a_right_angle() -> None:
    turns = Rotation.from_euler("z", [[0.0], [90.0], [180.0]], degrees=True).as_matrix()
    assert np.allclose(raised_deg(turns), [0.0, 90.0, 180.0])
