"""When feet stand, and that they then stand still: made-up steps whose contacts are known."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from animator.bvh import steady
from animator.skeleton.bones import OF_JOINTS, joints_of, skeleton_of
from animator.skeleton.foot_contact import STANDS_S, WANDERS_M, Stance, _bridged, _held, stances
from animator.skeleton.planted_feet import planted
from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES, extremities

RATE_HZ, STEP_S, STRIDE_M = 15.0, 0.6, 0.5
TIMES = np.arange(60) / RATE_HZ
FEET = ("knee", "ankle", "heel", "toe")


def walking(noise_m: float = 0.0) -> np.ndarray:
    """(60, 22, 3): feet take turns, the left one stands first; rows 0 to 8, 18 to 26 ...

    A foot swings over 0.5 m ahead within 0.6 s, 0.12 m high, while the other one stands.
    """
    rng = np.random.default_rng(3)
    poses = np.empty((len(TIMES), len(JOINT_NAMES), 3))
    for i, time_s in enumerate(TIMES):
        count, share = divmod(time_s / STEP_S + 1e-9, 1.0)
        z = {"l": STRIDE_M * ((count + 1) // 2), "r": STRIDE_M * (count // 2)}
        moving = "r" if count % 2 == 0 else "l"
        z[moving] += STRIDE_M * (share if moving == "r" else share - 1.0)
        middle = (z["l"] + z["r"]) / 2
        at: dict[str, Any] = {
            "pelvis": (0.0, 0.9, middle),
            "neck": (0.0, 1.4, middle),
            "head_top": (0, 1.7, middle),
        }
        for side, sign in (("l", 1.0), ("r", -1.0)):
            high = 0.12 * np.sin(np.pi * share) if side == moving else 0.0
            ankle = np.array([sign * 0.1, 0.068 + high, z[side]])
            hip = np.array([sign * 0.1, 0.9, middle])
            at[f"{side}_hip"], at[f"{side}_ankle"] = hip, ankle
            at[f"{side}_knee"] = (hip + ankle) / 2 + (0.0, 0.0, 0.1)
            for joint, y in (("shoulder", 1.35), ("elbow", 1.1), ("wrist", 0.85)):
                at[f"{side}_{joint}"] = (sign * 0.2, y, middle)
        poses[i] = [at[name] for name in JOINT_NAMES]
    poses += rng.normal(0.0, 1.0, poses.shape) * noise_m
    return np.concatenate([poses, extremities(poses, 1.7)], axis=1)


def ankle(joints_m: np.ndarray, side: str) -> np.ndarray:
    return joints_m[:, JOINT_NAMES.index(f"{side}_ankle")]


def slide_m(place_m: np.ndarray) -> float:
    return float(np.linalg.norm((place_m - np.median(place_m, axis=0))[:, [0, 2]], axis=1).max())


def test_feet_that_take_turns_are_told_apart() -> None:
    found = stances(walking(), TIMES)
    for side, begins in (("l", (0, 18, 36, 54)), ("r", (9, 27, 45))):
        own = [stance for stance in found if stance.side == side]
        assert [stance.first for stance in own] == pytest.approx(begins, abs=2)
    assert all(6 <= stance.end - stance.first <= 12 for stance in found if stance.end < 60)


def held_plainly(
    comes: np.ndarray, stays: np.ndarray, ankle_m: np.ndarray
) -> list[tuple[int, int]]:
    """The same with the median of all rows so far, anew at each row."""
    found, first = [], -1
    for i in range(len(comes)):
        if first >= 0:
            here = np.median(ankle_m[first:i], axis=0)
            if not stays[i] or np.linalg.norm((ankle_m[i] - here)[[0, 2]]) > WANDERS_M:
                found.append((first, i))
                first = -1
        if first < 0 and comes[i]:
            first = i
    return [*found, (first, len(comes))] if first >= 0 else found


@given(st.integers(0, 2**32 - 1), st.floats(0.001, 0.05), st.floats(0.5, 1.0))
@settings(max_examples=60, deadline=None)
def test_a_foot_is_held_as_by_the_plain_median(seed: int, noise_m: float, rest: float) -> None:
    rng = np.random.default_rng(seed)
    ankle_m = np.cumsum(rng.normal(0.0, noise_m, (80, 3)), axis=0) * rng.integers(0, 2, (80, 1))
    stays = rng.random(80) < rest
    comes = stays & (rng.random(80) < 0.5)
    assert _held(comes, stays, ankle_m) == held_plainly(comes, stays, ankle_m)


def test_who_stands_for_an_hour_is_told_in_a_moment() -> None:
    """54000 rows: with the median of all rows so far anew at each, more than a minute."""
    still = np.repeat(walking()[:1], 54_000, axis=0)
    still += np.random.default_rng(1).normal(0.0, 0.002, (54_000, 1, 3))
    assert sorted(stances(still, np.arange(54_000) / RATE_HZ)) == [
        Stance("l", 0, 54_000),
        Stance("r", 0, 54_000),
    ]


def test_a_gap_in_the_run_ends_a_contact() -> None:
    still = np.repeat(walking()[:1], 60, axis=0)
    still[30:32] = np.nan
    own = [stance for stance in stances(still, TIMES) if stance.side == "l"]
    assert own == [Stance("l", 0, 30), Stance("l", 32, 60)]


@pytest.mark.parametrize(
    ("away_m", "frames", "contacts"),
    [(0.2, 1, [(0, 60)]), (0.2, 5, [(0, 30), (35, 60)]), (0.0, 1, [(0, 60)])],
    ids=["for a moment", "for as long as a step takes", "never"],
)
def test_who_is_back_in_a_moment_has_not_stepped(
    away_m: float, frames: int, contacts: list[tuple[int, int]]
) -> None:
    """A track that starts is no step."""
    still = np.repeat(walking()[:1], 60, axis=0)
    still[30 : 30 + frames, JOINT_NAMES.index("l_ankle"), 0] += away_m
    own = [stance for stance in stances(still, TIMES) if stance.side == "l"]
    for stance, (first, end) in zip(own, contacts, strict=True):
        assert stance.first == pytest.approx(first, abs=2)
        assert stance.end == pytest.approx(end, abs=2)


def test_who_shuffles_far_steps_though_each_time_by_little() -> None:
    """3 cm every half second: after 6 cm the foot stands elsewhere than at first."""
    shuffled = np.repeat(walking()[:1], 60, axis=0)
    shuffled[:, :, 2] += 0.03 * (np.arange(60) // 8)[:, None]
    for stance in stances(shuffled, TIMES):
        assert np.ptp(ankle(shuffled, stance.side)[stance.first : stance.end, 2]) < 0.1


def test_who_is_in_the_air_does_not_stand() -> None:
    jumping = np.repeat(walking()[:1], 60, axis=0)
    jumping[20:30, :, 1] += 0.3
    told = np.zeros(60, bool)
    for stance in stances(jumping, TIMES):
        told[stance.first : stance.end] = True
    assert not told[20:30].any()
    assert told[:18].all()
    assert told[32:].all()


def test_a_standing_foot_that_was_tracked_unsteadily_is_held_still() -> None:
    """6 mm of noise a coordinate: 12 mm of slide before, none after; swings are left alone."""
    noisy = walking(0.006)
    run = planted(noisy, TIMES)
    for stance in stances(noisy, TIMES):
        rows = slice(stance.first, stance.end)
        assert slide_m(ankle(noisy, stance.side)[rows]) > 0.005
        assert slide_m(ankle(run.joints_m, stance.side)[rows]) < 1e-6
    far = run.held == 0
    assert far.any()
    for foot, side in enumerate("lr"):
        moved = np.linalg.norm(ankle(run.joints_m, side) - ankle(noisy, side), axis=1)
        assert moved[far[:, foot]].max() == pytest.approx(0.0, abs=1e-12)
        assert moved.max() < 0.08 + 1e-9


def test_the_skeleton_of_an_animation_stands_as_still() -> None:
    """Within 1 mm in half of the contacts, though its bones cannot follow the joints."""
    noisy = walking(0.006)
    skeleton, motion, steps = steady(noisy, TIMES)
    made = joints_of(skeleton, motion)
    assert steps.frames == 60
    slides = [
        slide_m(ankle(made, stance.side)[stance.first : stance.end])
        for stance in stances(noisy, TIMES)
    ]
    assert np.median(slides) < 1e-3
    assert max(slides) < 0.005
    pelvis = np.linalg.norm(made[:, 0] - noisy[:, 0], axis=1)
    assert np.percentile(pelvis, 95) < 0.02


def test_straight_legs_stay_straight_though_hips_come_nearer() -> None:
    """Bones of 0.83 m whose hip is 6 mm lower would push the knee out by 50 mm: the foot gives."""
    standing = np.repeat(walking()[:1], 60, axis=0)
    for side in "lr":
        at = [JOINT_NAMES.index(f"{side}_{name}") for name in ("hip", "knee", "ankle")]
        standing[:, at[2], 1:] = 0.068, 0.0
        standing[:, at[1]] = standing[:, [at[0], at[2]]].mean(axis=1)
        standing[:, at[1], 2] += 0.01
    upper = [i for i, name in enumerate(ALL_JOINT_NAMES) if name[2:] not in FEET]
    standing[:, upper, 1] -= 0.003 * np.sin(TIMES * 4.0)[:, None]
    skeleton, motion, _ = steady(standing, TIMES)
    made = joints_of(skeleton, motion)
    for side in "lr":
        knee = JOINT_NAMES.index(f"{side}_knee")
        assert np.linalg.norm(made[:, knee] - standing[:, knee], axis=1).max() < 0.01
        rises = ankle(made, side) - ankle(standing, side)
        assert np.abs(rises[:, 1]).max() < 0.015
        assert slide_m(ankle(made, side)) < 1e-3


def test_a_body_in_the_air_is_not_touched() -> None:
    flying = walking()
    flying[..., 1] += 0.4 * np.sin(np.linspace(0.0, 40.0, 60))[:, None]
    run = planted(flying, TIMES)
    untouched = run.held.max(axis=1) == 0
    assert untouched.sum() > 20
    assert (run.joints_m[untouched] == flying[untouched]).all()


def test_hands_and_feet_are_bones_where_a_run_has_them() -> None:
    whole = walking()
    assert len(skeleton_of(whole).bones) == OF_JOINTS[22] == 17
    assert len(skeleton_of(whole[:, :15]).bones) == OF_JOINTS[15] == 13
    skeleton, motion, _ = steady(whole, TIMES)
    made = joints_of(skeleton, motion)
    toe = ALL_JOINT_NAMES.index("l_toe")
    assert np.linalg.norm(made[:, toe] - whole[:, toe], axis=1).max() < 0.01


def stood(rows: tuple[int, int], rate_hz: float) -> list[Stance]:
    """Contacts of a left foot that is low and still in these of 60 rows, and high in others."""
    body = np.repeat(walking()[:1], 60, axis=0)
    body[:, JOINT_NAMES.index("l_ankle"), 1] += 0.3
    body[slice(*rows), JOINT_NAMES.index("l_ankle"), 1] -= 0.3
    found = stances(body, np.arange(60) / rate_hz)
    return [stance for stance in found if stance.side == "l"]


@pytest.mark.parametrize(("rows", "stands"), [((20, 23), False), ((20, 24), True)])
def test_a_foot_stands_that_is_down_for_long_enough_to_the_very_row(
    rows: tuple[int, int], stands: bool
) -> None:
    """At 20 Hz four rows last 0.15 s, however that is rounded; three only touch the floor."""
    assert pytest.approx(3 / 20.0) == STANDS_S
    padded = (rows[0] - 1, rows[1] + 1)  # while it comes down and goes up it is too fast
    assert bool(stood(padded, 20.0)) == stands


@pytest.mark.parametrize(("between", "steps"), [(5, False), (7, True)])
def test_a_foot_that_slips_off_for_as_long_as_it_may_has_not_stepped(
    between: int, steps: bool
) -> None:
    """At 20 Hz: from the last row of a contact to the first of the next, 0.3 s at most."""
    ankle_m = np.zeros((40, 3))
    ends, time_s = [(0, 15), (15 + between, 40)], np.arange(40) / 20.0
    low = np.ones(40, np.bool_)
    found = _bridged(ends, ankle_m, low, time_s)
    assert found == (ends if steps else [(0, 40)])
    low[16] = False
    assert _bridged(ends, ankle_m, low, time_s) == ends, "it was lifted"


@pytest.mark.parametrize("rows", [0, 1])
def test_a_run_of_one_row_is_left_as_it_is(rows: int) -> None:
    joints_m = np.random.default_rng(1).normal(0, 1, (rows, 22, 3))
    run = planted(joints_m, np.arange(rows) / 15)
    assert run.joints_m.tolist() == joints_m.tolist()
    assert run.held.tolist() == [[0.0, 0.0]] * rows


def test_two_rows_are_enough_for_a_foot_to_stand_or_not() -> None:
    """A foot that stands for as long as these rows stands still in both: their median is kept."""
    joints_m = np.tile(np.random.default_rng(1).normal(0, 1, (22, 3)), (2, 1, 1))
    run = planted(joints_m, np.array([0.0, 5.0]))
    assert run.joints_m == pytest.approx(joints_m)
    assert run.held.shape == (2, 2)
