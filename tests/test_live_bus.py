"""What the bus of a room asks of its session, whose every word is kept: no network."""

import logging
import queue
from collections.abc import Iterator
from typing import Any, NamedTuple

import msgspec
import pytest
import zenoh
from test_message_codec import BODY, GUIDE, REPORT

from common.bus.control_messages import ClockAnswer, ClockQuestion
from common.bus.inbox import Alive
from common.bus.live_bus import LiveBus
from common.bus.message_codec import MAX_BYTES, encode, key_of
from common.bus.messages import Body, Guide, Message, Picture, View

ROOM = "hall"
PICTURE = Picture(frame=7, captured_s=0.5, clock_s=0.5, viewer=2, jpeg=b"\xff\xd8")
SOON_S = 5.0


class Bytes(bytes):
    """A payload as Zenoh hands it out."""

    def to_bytes(self) -> bytes:
        return bytes(self)


class Told(NamedTuple):
    """A sample, a question or the good half of an answer."""

    key_expr: str
    payload: Bytes | None
    attachment: Bytes | None
    kind: Any = zenoh.SampleKind.PUT


def told(key: str, message: Message | None, number: int | None = 1, run: bytes = b"") -> Told:
    head = number.to_bytes(8, "big") if number is not None else b""
    return Told(key, Bytes(encode(message)) if message else None, Bytes(head + run))


class Declared:
    """Whatever was declared of a session: it can be heard, put to, and given up."""

    def __init__(self, key: str, log: list[Any], **how: Any) -> None:
        self.key_expr, self.how, self._log = key, how, log
        self.samples: queue.SimpleQueue[Told | None] = queue.SimpleQueue()

    def __iter__(self) -> Iterator[Told]:
        while (sample := self.samples.get()) is not None:
            yield sample

    def put(self, payload: bytes, attachment: bytes) -> None:
        self._log.append((self.key_expr, payload, attachment))

    def undeclare(self) -> None:
        self.samples.put(None)
        self._log.append(f"without {self.key_expr}")


class Session:
    """A session that keeps what was asked of it."""

    def __init__(self) -> None:
        self.log: list[Any] = []
        self.declared: list[Declared] = []
        self.serve: dict[str, Any] = {}
        self.replies: list[Any] = []

    def _declared(self, key: str, **how: Any) -> Declared:
        self.declared.append(Declared(key, self.log, **how))
        return self.declared[-1]

    def declare_publisher(self, key: str, **how: Any) -> Declared:
        return self._declared(key, **how)

    def declare_subscriber(self, key: str, channel: Any, **how: Any) -> Declared:
        return self._declared(key, channel=channel, **how)

    def declare_queryable(self, key: str, serve: Any) -> Declared:
        self.serve[key] = serve
        return self._declared(key)

    def declare_token(self, key: str) -> Declared:
        return self._declared(key)

    def liveliness(self) -> "Session":
        return self

    def get(self, key: str, **how: Any) -> list[Any]:
        self.log.append((key, how))
        return self.replies


class Query(NamedTuple):
    """A question on its way; whoever answers it closes it."""

    payload: Bytes | None
    attachment: Bytes | None
    said: list[Any]

    def __enter__(self) -> "Query":
        return self

    def __exit__(self, *_: object) -> None:
        self.said.append("closed")

    def reply(self, key: str, payload: bytes, attachment: bytes) -> None:
        if not payload:
            raise zenoh.ZError("the link is gone")
        self.said.append((key, payload, attachment))


class Reply(NamedTuple):
    ok: Told | None


def test_each_key_has_one_publisher_and_its_own_numbers_before_the_runs_word() -> None:
    session = Session()
    bus = LiveBus(session, ROOM, "word")
    other = msgspec.structs.replace(REPORT, viewer=1)
    for message in (REPORT, other, REPORT, PICTURE):
        bus.publish(message)
    assert session.log == [
        ("tritrack/hall/viewer/2/report", encode(REPORT), bytes(7) + b"\x01word"),
        ("tritrack/hall/viewer/1/report", encode(other), bytes(7) + b"\x01word"),
        ("tritrack/hall/viewer/2/report", encode(REPORT), bytes(7) + b"\x02word"),
        ("tritrack/hall/viewer/2/picture", encode(PICTURE), bytes(7) + b"\x01word"),
    ]
    drop, first, low = (
        zenoh.CongestionControl.DROP,
        zenoh.Priority.INTERACTIVE_HIGH,
        zenoh.Priority.DATA_LOW,
    )
    assert [one.how for one in session.declared] == [
        {"congestion_control": drop, "express": True, "priority": priority}
        for priority in (first, first, low)
    ]


def test_a_message_of_this_run_is_heard_and_counted_and_one_of_another_is_not(
    caplog: pytest.LogCaptureFixture,
) -> None:
    session = Session()
    bus = LiveBus(session, ROOM, "ours")
    inbox = bus.subscribe(Body)
    (subscriber,) = session.declared
    assert subscriber.key_expr == "tritrack/hall/body/pose"
    key, large = key_of(BODY, ROOM), Bytes(bytes(MAX_BYTES + 1))
    for sample in (
        told(key, BODY, 4, b"ours"),
        told(key, BODY, 9, b"theirs"),
        Told(key, Bytes(encode(BODY)), None),
        Told(key, large, Bytes(bytes(8) + b"ours")),
        told(key, BODY, 7, b"ours"),
    ):
        subscriber.samples.put(sample)
    assert [inbox.take(SOON_S), inbox.take(SOON_S)] == [BODY, BODY]
    assert (inbox.foreign, inbox.malformed, inbox.dropped) == (2, 1, 2)
    bus.close()
    assert caplog.messages == [
        f"{key}: dropped a message of another session: b'theirs'",
        f"{key}: dropped a message from {key}: 1000001 bytes, at most 1000000 are taken",
    ]


def test_who_has_no_word_hears_all_and_counts_what_bears_a_number() -> None:
    session = Session()
    bus = LiveBus(session, ROOM)
    inbox = bus.subscribe(Body)
    key = key_of(BODY, ROOM)
    for sample in (
        told(key, BODY, 3, b"theirs"),
        Told(key, Bytes(encode(BODY)), None),
        Told(key, Bytes(encode(BODY)), Bytes(bytes(7))),
        told(key, BODY, 5),
    ):
        session.declared[0].samples.put(sample)
    assert [inbox.take(SOON_S) for _ in range(4)] == [BODY] * 4
    assert (inbox.foreign, inbox.malformed, inbox.dropped) == (0, 0, 1)
    bus.close()


def test_what_counts_by_its_newest_alone_waits_in_a_short_ring() -> None:
    session = Session()
    bus = LiveBus(session, ROOM)
    for kind in (Guide, View):
        bus.subscribe(kind)
    ring, line = (one.how["channel"] for one in session.declared)
    assert isinstance(ring, zenoh.handlers.RingChannel)
    assert isinstance(line, zenoh.handlers.FifoChannel)
    bus.close()


def test_the_newest_that_was_kept_is_given_to_who_asks_and_belongs_to_this_run() -> None:
    session = Session()
    bus = LiveBus(session, ROOM, "ours")
    bus.publish(GUIDE)
    bus.keep(Guide)
    serve = session.serve["tritrack/hall/body/guide"]
    before, after, strange = list[Any](), list[Any](), list[Any]()
    serve(Query(None, Bytes(b"ours"), before))
    later = msgspec.structs.replace(GUIDE, frame=8)
    for guide in (GUIDE, later):
        bus.publish(guide)
    serve(Query(None, Bytes(b"ours"), after))
    serve(Query(None, Bytes(b"theirs"), strange))
    assert before == ["closed"]
    assert after == [("tritrack/hall/body/guide", encode(later), b"ours"), "closed"]
    assert strange == ["closed"]


def test_a_question_of_this_run_is_answered_once(caplog: pytest.LogCaptureFixture) -> None:
    session = Session()
    bus = LiveBus(session, ROOM, "ours")
    asked: list[ClockQuestion] = []
    answer, question = ClockAnswer(now_s=3.5), ClockQuestion(viewer=2, ready=True)

    def reply(what: ClockQuestion) -> ClockAnswer:
        asked.append(what)
        return answer

    bus.answer(ClockQuestion, reply)
    said: list[Any] = []
    serve = session.serve["tritrack/hall/clock"]
    serve(Query(Bytes(encode(question)), Bytes(b"ours"), said))
    assert said == [("tritrack/hall/clock", encode(answer), b"ours"), "closed"]
    with caplog.at_level(logging.WARNING):
        serve(Query(Bytes(encode(question)), Bytes(b"theirs"), said))
        serve(Query(Bytes(encode(question)), None, said))
        serve(Query(None, Bytes(b"ours"), said))
    assert said[2:] == ["closed"] * 3
    assert asked == [question]
    assert "tritrack/hall/clock: no answer to another session: b'theirs'" in caplog.text


def test_an_answer_that_cannot_be_sent_is_logged(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = Session()
    monkeypatch.setattr("common.bus.live_bus.encode", lambda _: b"")
    LiveBus(session, ROOM).answer(ClockQuestion, lambda _: ClockAnswer(now_s=1.0))
    said: list[Any] = []
    session.serve["tritrack/hall/clock"](Query(Bytes(encode(ClockQuestion())), None, said))
    assert said == ["closed"]
    assert "tritrack/hall/clock: an answer could not be sent: the link is gone" in caplog.text


def test_the_first_good_answer_of_this_run_is_taken() -> None:
    session = Session()
    bus = LiveBus(session, ROOM, "ours")
    key, question = "tritrack/hall/clock", ClockQuestion(viewer=2)
    good = [ClockAnswer(now_s=n) for n in (1.0, 2.0, 3.0)]
    session.replies = [
        Reply(None),
        Reply(told(key, good[0], None, b"theirs")),
        Reply(told(key, BODY, None, b"ours")),
        Reply(told(key, good[1], None, b"ours")),
        Reply(told(key, good[2], None, b"ours")),
    ]
    assert bus.ask(question, ClockAnswer, 0.75) == good[1]
    how = {"payload": encode(question), "timeout": 0.75, "attachment": b"ours"}
    assert session.log == [(key, how)]
    session.replies = session.replies[:3]
    assert bus.ask(question, ClockAnswer, 0.75) is None
    session.replies = [Reply(told("tritrack/hall/body/guide", GUIDE, None, b"ours"))]
    assert bus.latest(Guide, 0.25) == GUIDE
    how = {"payload": None, "timeout": 0.25, "attachment": b"ours"}
    assert session.log[-1] == ("tritrack/hall/body/guide", how)


def test_who_comes_and_goes_is_heard_also_of_those_who_came_before() -> None:
    session = Session()
    bus = LiveBus(session, ROOM)
    bus.announce("viewer 1")
    mailbox = bus.watch_alive()
    token, watch = session.declared
    assert (token.key_expr, watch.key_expr) == (
        "tritrack/hall/alive/viewer 1",
        "tritrack/hall/alive/*",
    )
    assert watch.how["history"] is True
    watch.samples.put(Told("tritrack/hall/alive/viewer 2", None, None))
    watch.samples.put(Told("tritrack/hall/alive/viewer 2", None, None, zenoh.SampleKind.DELETE))
    heard = [mailbox.take(SOON_S), mailbox.take(SOON_S)]
    assert heard == [Alive("viewer 2", alive=True), Alive("viewer 2", alive=False)]
    bus.close()


def test_a_closed_bus_has_given_up_all_that_it_declared() -> None:
    session = Session()
    bus = LiveBus(session, ROOM)
    inbox = bus.subscribe(Body)
    bus.answer(ClockQuestion, lambda _: ClockAnswer(now_s=1.0))
    bus.announce("viewer 1")
    bus.publish(GUIDE)
    session.log.clear()
    bus.close()
    assert session.log == [
        "without tritrack/hall/body/pose",
        "without tritrack/hall/clock",
        "without tritrack/hall/alive/viewer 1",
        "without tritrack/hall/body/guide",
    ]
    inbox.offer(key_of(BODY, ROOM), encode(BODY))
    assert inbox.drain() == []
    assert not [thread for _, thread, _ in bus._heard if thread.is_alive()]
