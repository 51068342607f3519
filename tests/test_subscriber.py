"""What the integrator hears of its viewers, and whom it waits for."""

from local_bus import LocalBus
from staging import report

from common.bus.control_messages import Ended
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
