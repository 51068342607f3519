"""When a run begins: once all viewers are ready, and somebody looks where that is waited for."""

import pytest
from staging import report

from common.bus.control_messages import ClockQuestion
from integrator.hearing.run_start import LEAD_S, Starter


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """What the room's clock says."""
    now = [100.0]
    monkeypatch.setattr("integrator.hearing.run_start.time.monotonic", lambda: now[0])
    return now


def ask(starter: Starter, viewer: int | None = None, ready: bool = False) -> float | None:
    answer = starter.answer(ClockQuestion(viewer=viewer, ready=ready))
    return answer.start_s


def test_a_run_begins_half_a_second_after_the_last_viewer_is_ready(clock: list[float]) -> None:
    starter = Starter(frozenset((1, 2)))
    assert starter.answer(ClockQuestion()).now_s == 100.0
    assert ask(starter, 1, True) is None
    assert ask(starter, 2, False) is None
    assert starter.start_s is None
    clock[0] = 107.0
    assert ask(starter, 2, True) == 107.0 + LEAD_S == starter.start_s
    clock[0] = 120.0
    assert ask(starter, 1, True) == 107.0 + LEAD_S, "once and for all"


def test_somebody_who_looks_is_waited_for_so_long(clock: list[float]) -> None:
    starter = Starter(frozenset((1,)), 30.0)
    assert ask(starter, 1, True) is None
    clock[0] = 129.9
    assert ask(starter) is None
    clock[0] = 130.0
    assert ask(starter) == 130.0 + LEAD_S
    looked = Starter(frozenset((1,)), 30.0)
    ask(looked, 1, True)
    looked.looked_at()
    clock[0] = 131.0
    assert ask(looked) == 131.0 + LEAD_S


def test_a_run_that_has_begun_begins_no_more(clock: list[float]) -> None:
    known = Starter(frozenset((1,)), start_s=90.0)
    assert ask(known, 1, True) == 90.0
    again = Starter(frozenset((1, 2)))
    again.begun(report(2, clock_s=98.0, captured_s=3.5))
    assert again.start_s == 94.5
    again.begun(report(2, clock_s=99.0, captured_s=3.5))
    assert ask(again, 1, True) == 94.5
