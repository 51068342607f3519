"""Frames as the models count them, held against a clock of 15 a second."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recognizer.model_rate import PERIOD_S, State, at_model_rate, counts, step


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


@pytest.mark.parametrize(
    ("late", "frames", "due_in"),
    [
        (-1.51, 1, -0.51),
        (-1.49, 0, 0.0),
        (-0.41, 0, 0.0),
        (-0.39, 1, 1.0),
        (0.59, 1, 1.0),
        (0.61, 2, 2.0),
        (2.59, 3, 3.0),
        (3.59, 4, 4.0),
        (3.61, 1, 4.61),
        (3.99, 1, 4.99),
    ],
)
def test_a_frame_stands_for_those_that_were_due_by_then(
    late: float, frames: int, due_in: float
) -> None:
    """In periods after the one that is due: what comes 0.4 early is on time, 4 are not skipped, and
    what was due 1.5 later is of a clip that began again."""
    due_s = 7.0
    state, count = step(State(due_s), due_s + late * PERIOD_S)
    assert count == frames
    assert state.due_s == pytest.approx(due_s + due_in * PERIOD_S)


def test_the_first_frame_is_due_whenever_it_comes() -> None:
    state, count = step(State(), 3.2)
    assert count == 1
    assert state.due_s == pytest.approx(3.2 + PERIOD_S)


def test_rows_are_repeated_as_often_as_their_frames_count() -> None:
    rows = np.arange(60.0).reshape(3, 20)
    found = at_model_rate([0.0, 2 * PERIOD_S, 2.4 * PERIOD_S], rows)
    assert found.tolist() == rows[[0, 1, 1]].tolist()
