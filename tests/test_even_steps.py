"""Rows of a run in a file of even steps: gaps stay gaps, and time is kept."""

import numpy as np
import pytest
from moving import random_joints

from animator.bvh import steady
from animator.even_steps import even_steps, with_gaps

PHONE_S = np.concatenate([np.arange(60) / 30, 2.0 + np.arange(72) / 24])
"""A phone's film in a room that goes dark after 2 s: 30, then 24 frames a second."""


def walking_past(time_s: np.ndarray) -> np.ndarray:
    """A posture that moves by 1 m/s: where it is says what time it is."""
    joints_m = np.repeat(random_joints(3, 2)[:1], len(time_s), axis=0)
    joints_m[..., 0] += time_s[:, None]
    return joints_m


def time_off_s(joints_m: np.ndarray, step_s: float) -> np.ndarray:
    """How far ahead of its time each frame of a file has the posture."""
    moved = joints_m[:, 0, 0] - joints_m[0, 0, 0]
    return np.asarray(moved - step_s * np.arange(len(moved)))


def test_rows_lie_where_their_time_says_and_gaps_stay_open() -> None:
    joints_m = random_joints(1, 10)
    joints_m[[0, 4]] = np.nan
    rows = np.delete(np.arange(10), 6)
    steps = even_steps(joints_m[rows], rows / 15)
    laid = with_gaps(joints_m[rows], steps)
    assert steps.frames == len(laid) == 9
    assert np.isnan(laid[[3, 5]]).all()
    seen = [0, 1, 2, 4, 6, 7, 8]
    assert np.array_equal(laid[seen], joints_m[1:][seen])


@pytest.mark.parametrize("fps", [30, 60, 30000 / 1001])
def test_times_in_whole_milliseconds_lose_no_row_and_make_no_gap(fps: float) -> None:
    """As cameras and other programs stamp frames; the file's rate is the camera's."""
    time_s = np.round(np.arange(2000) / fps, 3)
    steps = even_steps(np.zeros((2000, 15, 3)), time_s)
    assert np.array_equal(steps.places, np.arange(2000))
    assert 1 / steps.step_s == pytest.approx(fps, rel=1e-4)


def test_a_clock_that_trembles_and_frames_that_are_missing_keep_each_row_in_its_place() -> None:
    random = np.random.default_rng(0)
    rows = np.flatnonzero(random.random(9000) > 0.05)
    time_s = rows / 15 + random.normal(0.0, 0.003, len(rows))
    steps = even_steps(np.zeros((len(rows), 15, 3)), time_s)
    assert np.array_equal(steps.places, rows - rows[0])


def test_where_the_rate_varies_every_frame_has_the_place_of_its_time() -> None:
    """At the rate of the faster stretch; frames that were all tracked leave none empty."""
    joints_m = walking_past(PHONE_S)
    steps = even_steps(joints_m, PHONE_S)
    assert 1 / steps.step_s == pytest.approx(30.0, rel=1e-6)
    assert steps.frames == round(PHONE_S[-1] * 30) == 149
    assert steps.seen.all()
    assert time_off_s(with_gaps(joints_m, steps), steps.step_s) == pytest.approx(0.0, abs=1e-9)
    _, motion, _ = steady(joints_m, PHONE_S)
    assert time_off_s(motion.root_m[:, None], steps.step_s) == pytest.approx(0.0, abs=1e-9)


def test_a_rate_that_is_halved_leaves_no_frame_empty() -> None:
    time_s = np.concatenate([np.arange(60) / 30, 2.0 + np.arange(45) / 15])
    joints_m = walking_past(time_s)
    steps = even_steps(joints_m, time_s)
    assert steps.seen.all()
    assert time_off_s(with_gaps(joints_m, steps), steps.step_s) == pytest.approx(0.0, abs=1e-9)


def test_where_the_rate_varies_gaps_stay_open_too() -> None:
    """By hand: rows 20 to 22 have no pose, frames 20 to 22; rows 100 and 101 are missing, and
    between 3.625 and 3.75 s lie frames 109 to 112."""
    joints_m = walking_past(PHONE_S)
    joints_m[20:23] = np.nan
    kept = np.delete(np.arange(len(PHONE_S)), [100, 101])
    steps = even_steps(joints_m[kept], PHONE_S[kept])
    laid = with_gaps(joints_m[kept], steps)
    empty = np.flatnonzero(np.isnan(laid).any(axis=(1, 2)))
    assert empty.tolist() == [20, 21, 22, 109, 110, 111, 112]
    assert np.array_equal(np.isnan(laid).all(axis=(1, 2)), ~steps.seen)


def test_no_frame_of_a_file_is_off_by_more_than_a_quarter_of_its_step_to_either_side() -> None:
    """A camera that was stopped four times, for 11.45, 11.45, 10.55 and 10.55 frames."""
    starts = np.array([[0.0], [70.45], [140.9], [210.45], [280.0]])
    time_s = (starts + np.arange(60.0)).ravel() / 30
    joints_m = walking_past(time_s)
    steps = even_steps(joints_m, time_s)
    off_s = time_off_s(with_gaps(joints_m, steps), steps.step_s)
    assert np.ptp(off_s[steps.seen]) < 2 * 0.25 / 30


def test_rows_of_nearly_the_same_time_stand_one_after_the_other() -> None:
    time_s = np.array([0.0, 1.0, 2.0, 2.3, 3.0, 4.0, 5.0, 6.0, 7.0]) / 30
    _, motion, steps = steady(walking_past(time_s), time_s)
    assert (np.diff(steps.places) > 0).all()
    assert np.isfinite(motion.root_m).all()


def test_the_nearest_row_of_each_frame_is_that_of_its_time() -> None:
    steps = even_steps(walking_past(PHONE_S), PHONE_S)
    off_s = PHONE_S[steps.nearest()] - steps.step_s * np.arange(steps.frames)
    assert np.abs(off_s).max() <= 1 / 48 + 1e-9
