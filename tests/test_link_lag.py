"""How late views are heard: a slow link is waited for, a hiccup is not."""

import pytest

from integrator.hearing import link_lag
from integrator.hearing.link_lag import LONGEST_S, heard, init, lag_s, told

PERIOD_S = 1 / 15


def after(first_s: list[float], second_s: list[float]) -> link_lag.State:
    """Reports that come a period apart, so late each."""
    return on(init(PERIOD_S), first_s, second_s)


def on(state: link_lag.State, first_s: list[float], second_s: list[float]) -> link_lag.State:
    began_s = max(0.0, state.links[0].came_s)
    for n, (one, other) in enumerate(zip(first_s, second_s, strict=True), 1):
        now_s = began_s + n * PERIOD_S
        state = heard(heard(state, 1, now_s, one), 2, now_s, other)
    return state


def test_nobody_is_waited_for_before_anything_was_heard() -> None:
    assert lag_s(init(PERIOD_S)) == 0.0


def test_the_slower_link_is_waited_for() -> None:
    assert lag_s(after([0.02] * 40, [0.21, 0.25] * 20)) == pytest.approx(0.21)


def test_what_waited_behind_a_cut_is_not_taken_for_slow() -> None:
    """Six seconds of reports at once."""
    state = after([0.02] * 60, [0.02] * 60)
    now_s = state.links[1].came_s + 6.0
    for n in range(90):
        state = heard(state, 2, now_s + 1e-4 * n, 6.0 - n * PERIOD_S)
    assert lag_s(state) == pytest.approx(0.02)
    assert told(state, 12.0)[1] == []


def test_nobody_is_waited_for_for_ever() -> None:
    state = after([0.02] * 40, [3.0] * 40)
    assert lag_s(state) == LONGEST_S
    assert "bodies go without it" in told(state, 4.0)[1][0]


def test_a_clock_that_is_ahead_takes_nothing_off() -> None:
    assert lag_s(after([-3.0] * 40, [-3.0] * 40)) == 0.0


def test_a_slow_link_is_told_once_and_again_when_it_was_good_meanwhile() -> None:
    state, lines = told(after([0.02] * 40, [0.2] * 40), 4.0)
    assert lines == [
        "4.0 s: view 2 is heard 0.20 s late (its link is slow, or its clock was set); bodies wait "
        "for it"
    ]
    for late_s, said in ((0.2, 0), (0.02, 0), (0.2, 1)):
        state, lines = told(on(state, [0.02] * 40, [late_s] * 40), 5.0)
        assert len(lines) == said
    assert len(state.news) == 2
