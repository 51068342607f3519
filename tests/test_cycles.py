"""Cycles: of a motion that repeats itself, as long as its period; of another none."""

import numpy as np
import pytest

from animator.report.cycles import cycles_of, laid_over


def gait(period_s: float, rate_hz: float = 15.0, lasts_s: float = 13.0) -> tuple[np.ndarray, ...]:
    """Both knees and both hips, half a period apart, after a second of standing."""
    time_s = np.arange(round(lasts_s * rate_hz)) / rate_hz
    turn = 2 * np.pi * np.maximum(time_s - 1.0, 0.0) / period_s
    hip, other = 30 * np.sin(turn), 30 * np.sin(turn + np.pi) * (time_s > 1.0)
    knee, knees = 50 * np.maximum(np.sin(turn + 0.7), 0), 50 * np.maximum(np.sin(turn + 3.8), 0)
    return np.stack([hip, other, knee, knees], axis=1), time_s


@pytest.mark.parametrize("period_s", [0.9, 1.2, 2.4])
def test_a_cycle_lasts_as_long_as_the_period(period_s: float) -> None:
    """Not half of it: a step of the other foot is no repetition."""
    angles_deg, time_s = gait(period_s)
    found = cycles_of(angles_deg, time_s)
    assert found.lasts_s == pytest.approx(period_s, rel=0.06)
    assert len(found.spans) >= round(12.0 / period_s) - 2


def test_cycles_laid_over_each_other_are_one_curve() -> None:
    angles_deg, time_s = gait(1.2, rate_hz=30.0)
    found = cycles_of(angles_deg, time_s)
    laid = laid_over(angles_deg[:, 0], found, time_s)
    assert laid.shape == (len(found.spans), 101)
    assert np.ptp(laid, axis=0).max() < 8.0, "of 60 degrees"


def test_a_gap_takes_its_cycle_away_and_no_other() -> None:
    angles_deg, time_s = gait(1.0)
    whole = cycles_of(angles_deg, time_s)
    middle = sum(whole.spans[3]) // 2
    angles_deg[middle : middle + 2] = np.nan
    left = cycles_of(angles_deg, time_s)
    assert len(left.spans) == len(whole.spans) - 1
    assert not any(a <= middle <= b for a, b in left.spans)


def test_arms_that_are_lowered_once_do_not_hide_the_steps() -> None:
    """Both arms go down by a right angle before the walk: the widest motion of all."""
    angles_deg, time_s = gait(1.2)
    lowered = 90.0 / (1.0 + np.exp(8.0 * (time_s - 0.7)))
    both = np.column_stack([angles_deg, -lowered, -lowered, lowered, lowered])
    found = cycles_of(both, time_s)
    assert found.lasts_s == pytest.approx(1.2, rel=0.06)
    assert len(found.spans) >= 8


def test_what_does_not_repeat_itself_has_no_cycles() -> None:
    time_s = np.arange(150) / 15
    once = 60 / (1 + np.exp(-3 * (time_s - 5)))
    still = np.random.default_rng(1).normal(0, 1, (150, 4))
    assert cycles_of(np.stack([once, 2 * once], axis=1), time_s).spans == ()
    assert cycles_of(still, time_s).spans == ()
    assert cycles_of(np.full((150, 2), np.nan), time_s).spans == ()
    assert cycles_of(np.zeros((2, 2)), time_s[:2]).spans == ()


@pytest.mark.parametrize("time_s", [np.zeros(40), np.full(40, np.nan)])
def test_times_that_do_not_increase_have_no_cycles(time_s: np.ndarray) -> None:
    angles_deg = np.sin(np.arange(40) / 2)[:, None] * 30
    assert cycles_of(angles_deg, time_s).spans == cycles_of(angles_deg[:0], time_s[:0]).spans
