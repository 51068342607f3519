"""Rows of a run in a file of even steps: gaps stay gaps, and time is kept."""

import numpy as np
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
