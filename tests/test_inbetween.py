"""Key frames and the poses between them (thesis 4.1; T23)."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from animator.bones import BONES, Motion
from animator.inbetween import between, key_frames


@pytest.mark.parametrize(("frames", "thesis"), [(82, 17), (200, 33)], ids=["walking", "dancing"])
def test_there_are_about_as_many_key_frames_as_the_thesis_took(frames: int, thesis: int) -> None:
    """17 of 82 and 33 of 200."""
    found = key_frames(np.random.default_rng(1).random(frames))
    assert abs(len(found) - thesis) <= 0.2 * thesis


def test_the_frames_that_hide_least_are_taken() -> None:
    clarity = np.full(20, 0.4)
    clarity[[2, 8, 15]] = 0.9
    assert key_frames(clarity, apart=6).tolist() == [0, 2, 8, 15, 18, 19]


def test_frames_without_a_pose_are_never_keys() -> None:
    clarity = np.array([np.nan, np.nan, 0.2, 0.9, np.nan, np.nan, np.nan, 0.5, np.nan])
    assert key_frames(clarity, apart=3).tolist() == [2, 3, 7]
    assert key_frames(np.full(4, np.nan)).tolist() == []


def motion(count: int, seed: int = 0) -> Motion:
    turns = Rotation.random(count * len(BONES), random_state=seed).as_quat(scalar_first=True)
    root = np.random.default_rng(seed).normal(size=(count, 3))
    return Motion(root, turns.reshape(count, len(BONES), 4))


def test_the_motion_is_exact_at_the_key_frames() -> None:
    keys = np.array([0, 3, 4, 11])
    given_motion = motion(4)
    found = between(keys, given_motion, np.arange(12))
    assert np.array_equal(found.root_m[keys], given_motion.root_m)
    assert np.array_equal(found.turns[keys], given_motion.turns)


def test_between_key_frames_every_bone_turns_evenly_the_shorter_way() -> None:
    keys = np.array([0, 8])
    given_motion = motion(2, seed=3)
    found = between(keys, given_motion, np.arange(9))
    for bone in range(len(BONES)):
        ends = Rotation.from_quat(given_motion.turns[:, bone], scalar_first=True)
        expected = Slerp(keys, ends)(np.arange(9)).as_matrix()
        own = Rotation.from_quat(found.turns[:, bone], scalar_first=True).as_matrix()
        assert np.allclose(own, expected, atol=1e-6)
    assert np.allclose(found.root_m[4], given_motion.root_m.mean(axis=0))


def test_before_the_first_key_and_after_the_last_the_pose_is_held() -> None:
    given_motion = motion(2)
    found = between(np.array([5, 7]), given_motion, np.array([0, 5, 7, 30]))
    assert np.allclose(found.turns[[0, 3]], given_motion.turns)
    assert np.allclose(between(np.array([5]), motion(1), np.arange(9)).root_m, motion(1).root_m)
