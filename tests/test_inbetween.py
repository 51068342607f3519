"""Key frames and the poses between them (thesis 4.1; T23)."""

import numpy as np
import pytest
from moving import random_joints
from scipy.spatial.transform import Rotation

from animator.bvh import steady
from animator.inbetween import at, between, kept_within, key_frames
from animator.skeleton.bones import BONES, Motion, joints_of


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
    root = np.random.default_rng(seed).normal(size=(count, 3))
    bones = range(len(BONES))
    return Motion(root, tuple(Rotation.random(count, random_state=seed + bone) for bone in bones))


def test_the_motion_is_exact_at_the_key_frames() -> None:
    keys = np.array([0, 3, 4, 11])
    given_motion = motion(4)
    found = between(keys, given_motion, np.arange(12))
    assert np.array_equal(found.root_m[keys], given_motion.root_m)
    for own, given_turns in zip(found.turns, given_motion.turns, strict=True):
        assert np.allclose((own[keys] * given_turns.inv()).magnitude(), 0.0, atol=1e-14)


def test_between_key_frames_every_bone_turns_evenly_the_shorter_way() -> None:
    keys = np.array([0, 8])
    given_motion = motion(2, seed=3)
    found = between(keys, given_motion, np.arange(9))
    for own, ends in zip(found.turns, given_motion.turns, strict=True):
        way = (ends[0].inv() * ends[1]).as_rotvec()
        expected = ends[0] * Rotation.from_rotvec(np.linspace(0.0, 1.0, 9)[:, None] * way)
        assert np.allclose(own.as_matrix(), expected.as_matrix(), atol=1e-6)
    assert np.allclose(found.root_m[4], given_motion.root_m.mean(axis=0))


def test_before_the_first_key_and_after_the_last_the_pose_is_held() -> None:
    given_motion = motion(2)
    found = between(np.array([5, 7]), given_motion, np.array([0, 5, 7, 30]))
    for own, given_turns in zip(found.turns, given_motion.turns, strict=True):
        assert own[[0, 3]].approx_equal(given_turns).all()
    assert np.allclose(between(np.array([5]), motion(1), np.arange(9)).root_m, motion(1).root_m)


def test_more_frames_become_keys_until_what_lies_between_is_near() -> None:
    skeleton, moved, _ = steady(random_joints(3), np.arange(40) / 15)
    counts = []
    for most_m in (0.01, 0.03, 0.1):
        keys = kept_within(skeleton, moved, np.array([0, 39]), most_m)
        drawn = between(keys, at(moved, keys), np.arange(40))
        off_m = np.linalg.norm(joints_of(skeleton, drawn) - joints_of(skeleton, moved), axis=2)
        assert off_m.max() <= most_m
        assert {0, 39} <= set(keys.tolist())
        counts.append(len(keys))
    assert 40 >= counts[0] > counts[1] > counts[2] > 2


def test_a_motion_that_is_even_between_its_keys_gets_none_more() -> None:
    skeleton, moved, _ = steady(random_joints(3), np.arange(40) / 15)
    keys = np.array([0, 9])
    even = between(keys, at(moved, np.array([0, 39])), np.arange(10))
    assert kept_within(skeleton, even, keys, 1e-6).tolist() == [0, 9]
