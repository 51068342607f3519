"""Numbers of instants: time counts them, whether or not camera 1's viewer reports."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from integrator.frame_numbers import NO_FRAME, FrameTimes, frame_at

FILE = FrameTimes(1 / 15)
CAMERA = FrameTimes(1 / 15, counts=True)


@given(st.floats(-0.49, 0.49), st.integers(1, 5))
def test_instants_of_the_other_view_have_the_frames_that_camera_1_took_then(
    shift: float, every: int
) -> None:
    """However the two are shifted, up to half a period: none is left out, none comes twice."""
    times = FrameTimes(every / 15, every)
    before, numbers = -1, []
    for n in range(20):
        before = frame_at(times, (n + shift) * every / 15, before, None)
        numbers.append(before)
    assert numbers == [every * n for n in range(20)]


def test_a_frame_that_camera_1_never_took_has_no_number() -> None:
    """It misses two frames between its third and its fourth; its video goes on without."""
    times = FrameTimes(1.0, captured_s=(0.0, 1.0, 2.0, 5.0, 6.0))
    before, numbers = -1, []
    for second in range(9):
        number = frame_at(times, float(second), before, None)
        before = max(before, number)
        numbers.append(number)
    assert numbers == [0, 1, 2, NO_FRAME, NO_FRAME, 3, 4, 5, 6]


def test_a_camera_is_counted_on_from_what_was_heard_last() -> None:
    assert frame_at(CAMERA, 103.0, 40, 103.0 - 1 / 15) == 41
    assert frame_at(CAMERA, 103.0, 40, 103.0 - 3.1 / 15) == 43
    assert frame_at(CAMERA, 103.0, -1, None) == 0


@pytest.mark.parametrize("times", [FILE, FrameTimes(1 / 15, captured_s=(0.0, 1 / 15))])
def test_no_number_comes_twice(times: FrameTimes) -> None:
    assert frame_at(times, 1 / 15, 1, 1 / 15) == NO_FRAME
