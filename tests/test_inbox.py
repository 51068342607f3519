"""What a process takes in: checked, counted, and never let through where it is no message."""

import logging

import pytest
from test_message_codec import BODY, REPORT

from common.bus.control_messages import ClockAnswer, ClockQuestion
from common.bus.inbox import BOUND, MOST_GAP, Inbox, answered, checked
from common.bus.message_codec import encode, key_of
from common.bus.messages import Body, Guide, View

KEY = key_of(REPORT, "hall")


def test_what_came_on_its_own_key_is_taken_in_and_all_else_is_counted(
    caplog: pytest.LogCaptureFixture,
) -> None:
    """The first is logged, a hundred more are not."""
    box = Inbox(View, "hall")
    box.offer(KEY, encode(REPORT))
    box.offer(KEY.replace("/1/", "/2/").replace("/2/", "/3/"), encode(REPORT))
    box.offer(KEY, b"no message")
    assert (box.take(0.0), box.take(0.0)) == (REPORT, None)
    assert box.malformed == 2
    assert sum("dropped a message from" in line for line in caplog.messages) == 1
    box.refuse_foreign(KEY, b"another")
    box.refuse_foreign(KEY, b"")
    assert box.foreign == 2
    assert sum("of another session: b'another'" in line for line in caplog.messages) == 1
    box.close()
    box.offer(KEY, encode(REPORT))
    assert box.drain() == []


def test_numbers_that_are_missing_were_lost_on_the_way() -> None:
    box = Inbox(Body, "hall")
    for number in (5, 6, 9, 10):
        box.count("a", number)
    assert box.dropped == 2
    box.count("b", 100)
    assert box.dropped == 2, "another speaker"
    box.count("a", 0)
    box.count("a", 1)
    assert box.dropped == 2, "started again"
    box.count("a", 2 + MOST_GAP)
    assert box.dropped == 2 + MOST_GAP
    box.count("a", 4 + 2 * MOST_GAP)
    assert box.dropped == 2 + MOST_GAP, "nobody of ours loses so many"


def test_no_more_speakers_are_remembered_than_a_room_has() -> None:
    box = Inbox(Body, "hall")
    for speaker in range(BOUND + 1):
        box.count(str(speaker), 0)
        box.count(str(speaker), 2)
    assert box.dropped == BOUND


def test_of_what_only_the_newest_counts_nothing_is_lost() -> None:
    box = Inbox(Guide, "hall")
    box.count("a", 1)
    box.count("a", 9)
    assert box.dropped == 0


def test_a_question_is_answered_or_said_to_be_none(caplog: pytest.LogCaptureFixture) -> None:
    question = ClockQuestion(viewer=1, ready=True)
    answer = ClockAnswer(now_s=1.0, start_s=None)
    asked = []

    def reply(what: ClockQuestion) -> ClockAnswer:
        asked.append(what)
        return answer

    assert answered(reply, ClockQuestion, encode(question), "clock") == answer
    assert asked == [question]
    with caplog.at_level(logging.WARNING):
        assert answered(reply, ClockQuestion, encode(BODY), "clock") is None
        assert checked(b"", ClockQuestion, "clock") is None
    assert len(asked) == 1

    def broken(_: ClockQuestion) -> ClockAnswer:
        raise ValueError("no clock")

    assert answered(broken, ClockQuestion, encode(question), "clock") is None
    assert "clock: no answer to" in caplog.text
    assert "no clock" in caplog.text
