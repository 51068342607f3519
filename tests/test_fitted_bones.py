"""A body of fixed bones beside joints that were tracked: lengths kept, errors shared."""

import numpy as np
import pytest
from test_foot_contact import TIMES, walking

from animator.skeleton.bone_turns import motion_of
from animator.skeleton.bones import joints_of, skeleton_of
from animator.skeleton.fitted_bones import fitted
from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES

BONELESS = [ALL_JOINT_NAMES.index(name) for name in ("nose", "l_heel", "r_heel")]
EVEN = np.ones((60, 22, 3))


def apart_m(joints_m: np.ndarray, start: str, end: str) -> np.ndarray:
    ends = [ALL_JOINT_NAMES.index(name) for name in (start, end)]
    return np.asarray(np.linalg.norm(joints_m[:, ends[0]] - joints_m[:, ends[1]], axis=1))


def test_joints_that_fit_stay_where_they_are() -> None:
    steps = walking()
    skeleton = skeleton_of(steps)
    rigid = joints_of(skeleton, motion_of(skeleton, steps, TIMES))
    rigid[:, BONELESS] = steps[:, BONELESS]
    assert fitted(skeleton, rigid, EVEN) == pytest.approx(rigid, abs=1e-6)


def test_bones_keep_their_lengths_and_lie_nearer_than_aimed_ones() -> None:
    """Of noise of 1 cm, which bends and stretches all of them."""
    noisy = walking(0.01)
    skeleton = skeleton_of(noisy)
    near = fitted(skeleton, noisy, EVEN)
    for bone, tip in zip(skeleton.bones, skeleton.tips_m, strict=True):
        assert apart_m(near, bone.starts, bone.ends) == pytest.approx(np.linalg.norm(tip), abs=1e-4)
    made = joints_of(skeleton, motion_of(skeleton, near, TIMES))
    assert made[:, :15] == pytest.approx(near[:, :15], abs=2e-4)
    aimed = joints_of(skeleton, motion_of(skeleton, noisy, TIMES))
    off, aimed_off = (np.linalg.norm((each - noisy)[:, :15], axis=2) for each in (made, aimed))
    assert np.sqrt((off**2).mean()) < 0.8 * np.sqrt((aimed_off**2).mean())
    assert np.percentile(off, 95) < 0.8 * np.percentile(aimed_off, 95)


def test_what_a_bone_lacks_both_ends_share() -> None:
    """A head that was tracked 30 mm too far up: by hand, neck 10, head 20, were the trunk free."""
    steps = walking()
    skeleton = skeleton_of(steps)
    steps = fitted(skeleton, steps, EVEN)
    high = steps.copy()
    head, neck = JOINT_NAMES.index("head_top"), JOINT_NAMES.index("neck")
    high[:, head, 1] += 0.03
    free = EVEN.copy()
    others = [i for i, name in enumerate(JOINT_NAMES) if name not in ("head_top", "neck")]
    free[:, others] = 1e-9
    free[:, neck] = 2.0
    near = fitted(skeleton, high, free)
    assert (near - high)[:, head, 1] == pytest.approx(-0.02, abs=1e-4)
    assert (near - high)[:, neck, 1] == pytest.approx(0.01, abs=1e-4)


def test_what_is_held_fast_stays() -> None:
    noisy = walking(0.01)
    ankle = JOINT_NAMES.index("l_ankle")
    weights = EVEN.copy()
    weights[:, ankle] = 1e6
    near = fitted(skeleton_of(noisy), noisy, weights)
    assert near[:, ankle] == pytest.approx(noisy[:, ankle], abs=1e-6)


def test_rows_are_fitted_each_by_itself_however_many_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    noisy = walking(0.01)
    skeleton = skeleton_of(noisy)
    whole = fitted(skeleton, noisy, EVEN)
    monkeypatch.setattr("animator.skeleton.fitted_bones.AT_ONCE", 7)
    assert fitted(skeleton, noisy, EVEN) == pytest.approx(whole, abs=1e-12)
