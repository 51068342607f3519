"""Rows of a run in a file of even steps: gaps stay gaps, and time is kept."""

import numpy as np
import pytest
from moving import random_joints

from animator.even_steps import even_steps, with_gaps


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
