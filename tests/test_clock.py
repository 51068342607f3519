"""The room's clock from another host: the law of the round trip, held against simulated delays."""

import threading
import time
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.bus.bus import Bus
from common.bus.clock import (
    ASK_S,
    EXCHANGES,
    HISTORY,
    Exchange,
    Offset,
    asked,
    exchanged,
    followed,
    init,
    step,
)
from common.bus.control_messages import ClockAnswer, ClockQuestion

delays = st.floats(0.0, 5.0)


def exchange(sent_s: float, skew_s: float, there_s: float, back_s: float) -> Exchange:
    """A question to a room whose clock is ahead of this host's by `skew_s`."""
    return Exchange(sent_s, sent_s + there_s + skew_s, sent_s + there_s + back_s)


def told(asked: list[Exchange]) -> Offset:
    state = init()
    for one in asked:
        state, offset = step(state, one)
    return offset


@given(st.floats(-1e4, 1e4), st.lists(st.tuples(delays, delays), min_size=1))
def test_the_offset_errs_by_half_the_least_round_trip_at_most(
    skew_s: float, trips: list[tuple[float, float]]
) -> None:
    """However lopsided the ways there and back."""
    got = told([exchange(float(n), skew_s, *trip) for n, trip in enumerate(trips)])
    least_s = min(there + back for there, back in trips[-HISTORY:])
    assert got.error_s == pytest.approx(least_s / 2, abs=1e-9)
    assert abs(got.offset_s - skew_s) <= least_s / 2 + 1e-9


@pytest.mark.parametrize("seed", range(10))
def test_a_skew_of_200_ms_is_found_through_asymmetric_jitter(seed: int) -> None:
    """20 questions, 1-5 ms there and 2-40 ms back."""
    random = np.random.default_rng(seed)
    trips = zip(
        0.001 + random.exponential(0.002, 20), 0.002 + random.exponential(0.01, 20), strict=False
    )
    got = told([exchange(float(n), 0.2, float(a), float(b)) for n, (a, b) in enumerate(trips)])
    assert abs(got.offset_s - 0.2) <= got.error_s < 0.005


def test_an_equal_way_there_and_back_gives_the_skew_itself() -> None:
    assert told([exchange(0.0, -3.0, 0.5, 0.5)]) == Offset(-3.0, 0.5)


def test_old_exchanges_are_forgotten_so_that_a_drift_is_followed() -> None:
    """The best one of all is too old to count."""
    old = exchange(0.0, 1.0, 0.0, 0.0)
    later = [exchange(float(n), 2.0, 0.01, 0.01) for n in range(1, HISTORY + 1)]
    assert told([old, *later]).offset_s == pytest.approx(2.0)
    assert told([old, *later[:-1]]).offset_s == pytest.approx(1.0)


class Drifting:
    """A room whose clock gains a tenth of a second in each, and that is away for a while."""

    began_s = time.monotonic()
    away = threading.Event()

    def ask(self, *_: Any) -> ClockAnswer | None:
        if self.away.is_set():
            return None
        now_s = time.monotonic()
        return ClockAnswer(now_s=now_s + 5.0 + 0.1 * (now_s - self.began_s), start_s=0.0)


def test_a_clock_that_drifts_is_followed_while_a_run_goes_on() -> None:
    """Where nobody answers, what was known last holds."""
    room, told = Drifting(), list[float]()

    def true_s() -> float:
        return 5.0 + 0.1 * (time.monotonic() - room.began_s)

    with followed(cast(Bus, room), told.append, again_s=0.005):
        while len(told) < 20:
            time.sleep(0.01)
        first_s = told[0]
        time.sleep(0.5)
        assert abs(told[-1] - true_s()) < abs(first_s - true_s())
        room.away.set()
        time.sleep(0.05)
        known = len(told)
        time.sleep(0.05)
        assert len(told) == known
    room.away.clear()
    time.sleep(0.02)
    assert len(told) == known, "the thread is over"


class Room:
    """A room 100 s ahead that answers so many questions, each after its own way there and back."""

    def __init__(self, *trips_s: tuple[float, float]) -> None:
        self.now_s, self.trips_s = 10.0, [*trips_s]
        self.asked: list[tuple[object, object, float]] = []

    def ask(self, question: object, kind: object, timeout_s: float) -> ClockAnswer | None:
        self.asked.append((question, kind, timeout_s))
        if not self.trips_s:
            return None
        there_s, back_s = self.trips_s.pop(0)
        self.now_s += there_s
        answer = ClockAnswer(now_s=self.now_s + 100.0, start_s=7.0)
        self.now_s += back_s
        return answer


def in_room(*trips_s: tuple[float, float], monkeypatch: pytest.MonkeyPatch) -> Any:
    room = Room(*trips_s)
    monkeypatch.setattr("time.monotonic", lambda: room.now_s)
    return room


def test_an_exchange_is_when_it_was_asked_what_was_said_and_when_it_came(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    room, question = in_room((1.0, 3.0), monkeypatch=monkeypatch), ClockQuestion(viewer=2)
    answer = ClockAnswer(now_s=111.0, start_s=7.0)
    assert exchanged(room, question) == (Exchange(10.0, 111.0, 14.0), answer)
    assert room.asked == [(question, ClockAnswer, ASK_S)]
    assert exchanged(room, question) is None


def test_the_quickest_of_five_answers_is_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    """By hand: 0.1 s there and 0.3 back err by 0.1; a sixth would be better and is not asked."""
    trips_s = [(1.0, 2.0), (0.1, 0.3), (4.0, 0.0), (0.5, 0.5), (2.0, 2.0), (0.0, 0.0)]
    room = in_room(*trips_s, monkeypatch=monkeypatch)
    got = asked(room)
    assert (got.offset_s, got.error_s) == pytest.approx((99.9, 0.2))
    assert len(room.asked) == EXCHANGES == 5


def test_where_no_one_answers_any_more_the_answers_so_far_hold(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    room = in_room((1.0, 2.0), (3.0, 2.0), monkeypatch=monkeypatch)
    assert asked(room) == Offset(99.5, 1.5)
    assert len(room.asked) == 3
    assert asked(room) == Offset(0.0, 0.0)
    assert len(room.asked) == 4


def test_a_clock_is_told_from_the_fifth_answer_on() -> None:
    """Before that a slow link would tell what it does not know; who is silent in between is not
    counted."""
    for answers, tells in ((4, 0), (5, 1), (6, 2)):
        room, told = Room(*[(0.25, 0.25)] * answers), list[float]()
        with followed(cast(Bus, room), told.append, again_s=0.001):
            until_s = time.monotonic() + 5.0
            while len(room.asked) < answers + 2 and time.monotonic() < until_s:
                time.sleep(0.001)
        assert "the room's clock" not in [thread.name for thread in threading.enumerate()]
        assert len(told) == tells
