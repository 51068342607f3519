"""How late views are heard: a slow link is waited for, a hiccup is not."""

import pytest

from integrator.hearing import link_lag
from integrator.hearing.link_lag import LONGEST_S, LOOKS_AT, heard, init, lag_s, told

PERIOD_S = 1 / 15


def after(state: link_lag.State, first_s: list[float], second_s: list[float]) -> link_lag.State:
    for one, other in zip(first_s, second_s, strict=True):
        state = heard(heard(state, 1, one), 2, other)
    return state


def test_nobody_is_waited_for_before_anything_was_heard() -> None:
    assert lag_s(init(PERIOD_S)) == 0.0


def test_the_slower_link_is_waited_for() -> None:
    state = after(init(PERIOD_S), [0.02] * 40, [0.21, 0.25] * 20)
    assert lag_s(state) == pytest.approx(0.21)


def test_who_froze_and_catches_up_is_not_taken_for_slow() -> None:
    """Two seconds of reports at once, each late by what is left of them."""
    caught_up = [2.0 - n * PERIOD_S for n in range(LOOKS_AT - 1)]
    state = after(init(PERIOD_S), [0.02] * 60, [*[0.02] * 31, *caught_up])
    assert lag_s(state) == pytest.approx(0.02)
    assert told(state, 4.0)[1] == []


def test_nobody_is_waited_for_for_ever() -> None:
    state = after(init(PERIOD_S), [0.02] * 40, [3.0] * 40)
    assert lag_s(state) == LONGEST_S
    assert "bodies go without it" in told(state, 4.0)[1][0]


def test_a_clock_that_is_ahead_takes_nothing_off() -> None:
    assert lag_s(after(init(PERIOD_S), [-3.0] * 40, [-3.0] * 40)) == 0.0


def test_a_slow_link_is_told_once_and_again_when_it_was_good_meanwhile() -> None:
    state = after(init(PERIOD_S), [0.02] * 40, [0.2] * 40)
    state, lines = told(state, 4.0)
    assert lines == [
        "4.0 s: view 2 is heard 0.20 s late: its link is slow, or its clock was set; bodies wait "
        "for it"
    ]
    state, lines = told(after(state, [0.02] * 40, [0.2] * 40), 5.0)
    assert lines == []
    state, lines = told(after(state, [0.02] * 40, [0.02] * 40), 6.0)
    assert lines == []
    state, lines = told(after(state, [0.02] * 40, [0.2] * 40), 7.0)
    assert len(lines) == 1
    assert len(state.news) == 2
