"""Keeping time, on clocks that the test turns by hand."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.bus.control_messages import Ended, Pulse
from common.bus.message_codec import TOPICS
from common.bus.messages import View
from common.bus.rate import WINDOW, Pace, silent, wait_until

PERIOD_S = 1 / 15


def test_a_frame_is_missed_when_its_work_ends_a_period_after_it_was_due() -> None:
    """P1: 66.7 ms a frame is the deadline."""
    pace = Pace(PERIOD_S)
    for frame, late_s in enumerate([0.0, 0.0666, 0.0667, 0.02, 0.5]):
        pace.done(due_s=float(frame), now_s=frame + late_s)
    assert (pace.frames, pace.misses) == (5, 2)


def test_a_steady_run_has_its_own_rate() -> None:
    pace = Pace(PERIOD_S)
    for frame in range(40):
        pace.done(frame / 15, frame / 15 + 0.01)
    assert pace.fps == pytest.approx(15.0)
    assert pace.latency_ms(0.5) == pytest.approx(10.0)


def test_the_quantiles_of_a_hundred_known_times() -> None:
    pace = Pace(PERIOD_S)
    for n in range(100, 0, -1):
        pace.done(0.0, n / 1000)
    assert pace.latency_ms(0.5) == pytest.approx(50.0)
    assert pace.latency_ms(0.99) == pytest.approx(99.0)
    assert pace.latency_ms(1.0) == pytest.approx(100.0)


def test_the_window_forgets_a_bad_start_and_the_count_does_not() -> None:
    pace = Pace(PERIOD_S)
    pace.done(0.0, 9.0)
    for frame in range(WINDOW):
        pace.done(10.0 + frame, 10.0 + frame)
    assert pace.latency_ms(1.0) == 0.0
    assert pace.misses == 1


def test_nothing_done_is_no_division_by_zero() -> None:
    pace = Pace(PERIOD_S)
    assert (pace.fps, pace.latency_ms(0.99)) == (0.0, 0.0)
    pace.done(1.0, 1.0)
    pace.done(1.0, 1.0)
    assert pace.fps == 0.0


@given(st.lists(st.floats(0.0, 10.0), min_size=1, max_size=50), st.floats(0.0, 1.0))
def test_a_quantile_is_one_of_the_times_and_holds_that_share(
    late_s: list[float], share: float
) -> None:
    pace = Pace(PERIOD_S)
    for late in late_s:
        pace.done(0.0, late)
    found_s = pace.latency_ms(share) / 1000
    assert any(found_s == pytest.approx(late) for late in late_s)
    within = sum(late <= found_s * (1 + 1e-9) for late in late_s)
    assert within >= share * len(late_s) - 1e-9


class HandTurned(threading.Event):
    """A stop sign whose waiting turns the clock, each time by less than was asked for."""

    def __init__(self) -> None:
        super().__init__()
        self.now_s = 100.0
        self.asked: list[float] = []

    def wait(self, timeout: float | None = None) -> bool:
        assert timeout is not None
        self.asked.append(timeout)
        self.now_s += max(0.6 * timeout, 0.001)
        return self.is_set()


def test_waiting_ends_at_the_moment_and_not_before() -> None:
    sign = HandTurned()
    assert wait_until(101.0, sign, lambda: sign.now_s)
    assert 101.0 <= sign.now_s < 101.01
    assert sign.asked[0] == pytest.approx(1.0)


def test_a_moment_that_is_past_is_not_waited_for() -> None:
    sign = HandTurned()
    assert wait_until(99.0, sign, lambda: sign.now_s)
    assert sign.asked == []


def test_waiting_ends_when_it_is_stopped() -> None:
    stop = threading.Event()
    stop.set()
    assert not wait_until(1e9, stop)
    assert not wait_until(0.0, stop)


def test_silence_follows_from_the_rate_of_the_topic() -> None:
    """A viewer at 15 Hz is silent after a third of a second, a pulse a second after five."""
    report_hz, pulse_hz = TOPICS[View].hz, TOPICS[Pulse].hz
    assert not silent(report_hz, 10.0, 10.0 + 4.9 / 15)
    assert silent(report_hz, 10.0, 10.0 + 5.1 / 15)
    assert not silent(pulse_hz, 10.0, 14.9)
    assert silent(pulse_hz, 10.0, 15.1)


def test_what_is_said_irregularly_is_never_silent() -> None:
    assert not silent(TOPICS[Ended].hz, 0.0, 1e6)
