"""What the integrator hears of its viewers, and whom it waits for."""

import time

import pytest
from local_bus import LocalBus
from staging import report

from common.bus.control_messages import Ended
from common.bus.inbox import Inbox
from common.bus.messages import View
from integrator.hearing.subscriber import GATHER_S, OVERDUE_PERIODS, Subscriber

PERIOD_S = 1 / 15
OVER = tuple(Ended(viewer=viewer, frames=330) for viewer in (1, 2))


def test_who_had_ended_before_it_listened_is_not_waited_for() -> None:
    """An integrator in the place of one that was killed hears no last word a second time."""
    assert not Subscriber(LocalBus(), (1, 2), PERIOD_S, 0.0, OVER).going
    assert Subscriber(LocalBus(), (1, 2), PERIOD_S, 0.0, OVER[1:]).going


def test_one_view_goes_on_alone_once_the_other_is_over() -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus, (1, 2), PERIOD_S, 0.0, OVER[1:])
    bus.publish(report(1))
    assert [pair.views[0] is not None for pair in subscriber.instants()] == [True]


def test_what_was_said_last_is_left_to_the_next() -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus, (1, 2), PERIOD_S, 0.0)
    bus.publish(OVER[0])
    subscriber.instants()
    assert subscriber.over == OVER[:1]


def test_a_last_report_that_comes_as_the_wait_runs_out_keeps_its_partner(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The other view's waits already; the last word came behind it, on a channel of its own."""
    bus, wait = LocalBus(), Inbox.take
    subscriber, now_s = Subscriber(bus, (1, 2), 1.0, 0.0), time.monotonic()
    bus.publish(report(2, clock_s=now_s))
    assert subscriber.instants() == []
    late = [report(1, clock_s=now_s), OVER[0]]

    def runs_out(inbox: Inbox[View], timeout_s: float) -> View | None:
        found = wait(inbox, timeout_s)
        while found is None and late:
            bus.publish(late.pop(0))
        return found

    monkeypatch.setattr(Inbox, "take", runs_out)
    pairs = [pair for _ in range(3) for pair in subscriber.instants()]
    assert [None in pair.views for pair in pairs] == [False]
    assert subscriber.over == OVER[:1]


class Clock:
    """Time that passes as the test says."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_s, self.slept_s = 100.0, list[float]()
        monkeypatch.setattr(time, "monotonic", lambda: self.now_s)
        monkeypatch.setattr(time, "sleep", self.sleep)
        monkeypatch.setattr(Inbox, "take", lambda inbox, _: next(iter(inbox.drain()), None))

    def sleep(self, for_s: float) -> None:
        self.slept_s.append(for_s)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


@pytest.mark.parametrize("period_s", [0.1, 0.05])
def test_a_report_that_has_no_partner_goes_on_alone_after_two_periods(
    clock: Clock, period_s: float
) -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus, (1, 2), period_s, 0.0, start_s=99.0)
    bus.publish(report(1, clock_s=clock.now_s))
    assert subscriber.instants() == []
    clock.now_s += OVERDUE_PERIODS * period_s - 0.01
    assert subscriber.instants() == []
    clock.now_s += 0.02
    (alone,) = subscriber.instants()
    assert (alone.views[0] is not None, alone.views[1]) == (True, None)


@pytest.mark.parametrize("started", [None, 99.0], ids=["from the start", "in the place of one"])
def test_what_comes_at_the_very_first_is_gathered_for_a_moment_and_later_no_more(
    clock: Clock, started: float | None
) -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus, (1, 2), PERIOD_S, 0.0, start_s=started)
    subscriber.instants()
    assert clock.slept_s == []
    for frame in range(3):
        bus.publish(report(1, frame=frame, clock_s=clock.now_s))
        subscriber.instants()
    assert clock.slept_s == [GATHER_S]


def test_times_of_view_2_are_set_back_and_waited_for_as_much_longer(clock: Clock) -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus, (1, 2), 0.1, 0.0, start_s=99.0)
    subscriber.late_s = 0.5
    bus.publish(report(1, captured_s=7.0, clock_s=clock.now_s))
    assert subscriber.instants() == []
    clock.now_s += 0.3
    assert subscriber.instants() == [], "longer than two periods"
    bus.publish(report(2, captured_s=7.5, clock_s=clock.now_s))
    (both,) = subscriber.instants()
    assert both.views[0] is not None
    assert both.views[1] is not None
    assert both.views[1].captured_s == pytest.approx(7.0)
