"""What the integrator hears of its viewers, and whom it waits for."""

import time

import pytest
from local_bus import LocalBus
from staging import report

from common.bus.control_messages import Ended
from common.bus.inbox import Inbox
from common.bus.messages import Report
from integrator.hearing.subscriber import Subscriber

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
    assert [pair.first is not None for pair in subscriber.pairs()] == [True]


def test_what_was_said_last_is_left_to_the_next() -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus, (1, 2), PERIOD_S, 0.0)
    bus.publish(OVER[0])
    subscriber.pairs()
    assert subscriber.over == OVER[:1]


def test_a_last_report_that_comes_as_the_wait_runs_out_keeps_its_partner(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The other view's waits already; the last word came behind it, on a channel of its own."""
    bus, wait = LocalBus(), Inbox.take
    subscriber, now_s = Subscriber(bus, (1, 2), 1.0, 0.0), time.monotonic()
    bus.publish(report(2, clock_s=now_s))
    assert subscriber.pairs() == []
    late = [report(1, clock_s=now_s), OVER[0]]

    def runs_out(inbox: Inbox[Report], timeout_s: float) -> Report | None:
        found = wait(inbox, timeout_s)
        while found is None and late:
            bus.publish(late.pop(0))
        return found

    monkeypatch.setattr(Inbox, "take", runs_out)
    pairs = [pair for _ in range(3) for pair in subscriber.pairs()]
    assert [None in pair for pair in pairs] == [False]
    assert subscriber.over == OVER[:1]
