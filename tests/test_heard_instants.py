"""What the page's process makes of bodies, reports and postures on the bus."""

import time

import pytest
from local_bus import LocalBus
from show_page import beside, snapshot_at

from animator.heard_instants import TOGETHER_S, Subscriber
from common.bus.inbox import Inbox
from common.bus.messages import Body, Performance, Posture


def body_of(person: int, frame: int) -> Body:
    body = (beside(frame, person, 0.0) if person else snapshot_at(frame)).body
    assert body is not None
    return body


def posture_of(person: int, frame: int, event: Performance | None = None) -> Posture:
    return Posture(
        person=person,
        frame=frame,
        captured_s=frame / 15,
        clock_s=0.0,
        name=f"of {person}",
        event=event,
    )


def heard(bus: LocalBus, subscriber: Subscriber, *bodies: Body) -> list[tuple[int, int]]:
    for body in bodies:
        bus.publish(body)
    first = subscriber.bodies.take(1.0)
    assert first is not None
    return [(body.frame, body.person) for body in subscriber.newest(first)]


def test_all_bodies_of_the_newest_instant_are_shown_at_once_by_number() -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus)
    early = [body_of(1, 3), body_of(2, 3), body_of(3, 3)]
    assert heard(bus, subscriber, *early, body_of(2, 4), body_of(1, 4)) == [(4, 1), (4, 2)]


def test_a_body_that_comes_a_moment_later_belongs_to_its_instant(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bus = LocalBus()
    subscriber, take, late = Subscriber(bus), Inbox.take, [body_of(2, 3)]

    def taken(inbox: Inbox[Body], timeout_s: float) -> Body | None:
        found = take(inbox, timeout_s)
        if found is None and late:
            bus.publish(late.pop())
            found = take(inbox, timeout_s)
        return found

    monkeypatch.setattr(Inbox, "take", taken)
    assert heard(bus, subscriber, body_of(1, 3)) == [(3, 1), (3, 2)]


def test_the_body_of_a_run_that_follows_one_person_waits_for_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus)
    first = body_of(0, 3)
    monkeypatch.setattr(subscriber.bodies, "take", lambda _: pytest.fail("it waits"))
    begun_s = time.monotonic()
    assert subscriber.newest(first) == [first]
    assert time.monotonic() - begun_s < TOGETHER_S


def test_each_person_has_a_posture_and_performances_of_their_own() -> None:
    bus = LocalBus()
    subscriber = Subscriber(bus)
    squat = Performance("squat", 0, 3, 0.0, 0.2, 1.0, 1)
    for posture in (posture_of(1, 3), posture_of(2, 3, squat), posture_of(1, 4)):
        bus.publish(posture)
    snapshot, ended = subscriber.with_bodies([body_of(1, 4), body_of(2, 4)])
    assert snapshot.posture is not None
    assert (snapshot.posture.name, snapshot.posture.frame, snapshot.performed) == ("of 1", 4, "")
    (other,) = snapshot.others
    assert other.posture is not None
    assert (other.body.person, other.posture.name, other.performed) == (2, "of 2", "squat")
    assert [(posture.person, posture.event) for posture in ended] == [(2, squat)]
    assert subscriber.with_bodies([body_of(2, 5)])[0].performed == "squat", "they are the first now"
