"""Frames as the models count them, held against a clock of 15 a second."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recognizer.model_rate import PERIOD_S, at_model_rate, counts


def test_a_camera_of_the_papers_rate_is_taken_frame_by_frame() -> None:
    """P1."""
    assert counts([100.0 + n / 15 for n in range(900)]).tolist() == [1] * 900


@given(st.lists(st.floats(-0.024, 0.024), min_size=2, max_size=60))
def test_one_whose_clock_trembles_is_too(late_s: list[float]) -> None:
    """By less than makes a frame another moment's."""
    times = [n / 15 + off for n, off in enumerate([0.0, *late_s])]
    assert counts(times).tolist() == [1] * len(times)


@pytest.mark.parametrize("hz", [7.5, 10, 12, 20, 24, 25, 29.97, 30, 50, 59.94, 60, 120])
def test_ten_seconds_of_any_camera_are_as_many_frames(hz: float) -> None:
    times = [n / hz for n in range(int(10 * hz))]
    assert sum(counts(times)) == pytest.approx(150, abs=2)
    rows = at_model_rate(times, np.repeat(np.array(times)[:, None], 20, axis=1))
    apart_s = np.abs(rows[:, 0] - np.arange(len(rows)) * PERIOD_S)
    assert apart_s.max() <= max(0.7 * PERIOD_S, 0.7 / hz)


def test_a_gap_or_a_clip_that_begins_again_is_no_slow_camera() -> None:
    assert counts([0.0, PERIOD_S, 5.0, 5.0 + PERIOD_S]).tolist() == [1, 1, 1, 1]
    assert counts([8.0, 8.0 + PERIOD_S, 0.0, PERIOD_S]).tolist() == [1, 1, 1, 1]
