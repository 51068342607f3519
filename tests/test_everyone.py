"""Postures of several people: each person's bodies are judged as if they were alone."""

from typing import Any

from common.bus.messages import Body, Performance, Posture
from recognizer import everyone
from recognizer.everyone import MOST


def body_of(person: int, frame: int) -> Body:
    moment: dict[str, Any] = {"frame": frame, "captured_s": frame / 15, "clock_s": 0.0}
    return Body(person=person, status="tracking", views="both", **moment)


def counted(seen: int, body: Body) -> tuple[int, Posture]:
    """A stream that counts its bodies."""
    posture = Posture(
        person=body.person,
        frame=body.frame,
        captured_s=body.captured_s,
        clock_s=0.0,
        name=str(seen + 1),
    )
    return seen + 1, posture


def test_each_person_has_a_stream_of_their_own() -> None:
    state = everyone.init(0)
    names = []
    for person, frame in ((1, 0), (2, 0), (1, 1), (1, 2), (2, 2)):
        state, posture = everyone.step(state, body_of(person, frame), counted)
        names.append((posture.person, posture.name))
    assert names == [(1, "1"), (2, "1"), (1, "2"), (1, "3"), (2, "2")]


def test_at_the_end_each_stream_tells_what_it_cut_off() -> None:
    def end(seen: int, last: Posture) -> Posture | None:
        event = Performance("kick", 0, seen, 0.0, 1.0, 0.9)
        return Posture(
            person=last.person, frame=-1, captured_s=0.0, clock_s=0.0, name="", event=event
        )

    state = everyone.init(0)
    for person in (1, 2, 1):
        state, _ = everyone.step(state, body_of(person, 0), counted)
    told = list(everyone.finished(state, end))
    assert [(one.person, one.event and one.event.end) for one in told] == [(2, 1), (1, 2)]
    assert list(everyone.finished(state, lambda *_: None)) == []


def test_of_many_people_the_streams_of_those_who_came_last_are_kept() -> None:
    state = everyone.init(0)
    for person in range(MOST + 3):
        state, _ = everyone.step(state, body_of(person, 0), counted)
    assert [each.person for each in state.streams] == list(range(3, MOST + 3))
