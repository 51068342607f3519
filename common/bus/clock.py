"""The room's clock as another host reads it: of several exchanges, the quickest is believed."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, NamedTuple

from common.bus.control_messages import ClockAnswer, ClockQuestion

if TYPE_CHECKING:
    from common.bus.bus import Bus

ASK_S: Final = 0.5
"""How long to wait for an answer, seconds."""
EXCHANGES: Final = 5
"""Number of exchanges at the start."""

AGAIN_S: Final = 2.0
"""Seconds between two questions while a run goes on."""
HISTORY: Final = 32
"""Number of exchanges that are remembered. Clocks do not drift apart much within them: 50 ppm
make 3 ms in a minute of a question every AGAIN_S, 180 ms in an hour."""


class Exchange(NamedTuple):
    """One question and its answer."""

    sent_s: float
    """When the question left, by this host's clock."""
    room_s: float
    """The room's clock when the answer was sent."""
    received_s: float
    """When the answer came, by this host's clock."""

    @property
    def round_trip_s(self) -> float:
        """Round-trip time, seconds."""
        return self.received_s - self.sent_s


class Offset(NamedTuple):
    """Offset to add to this host's clock to get the room's."""

    offset_s: float
    error_s: float
    """Largest possible error of the offset: half the round trip."""


State = tuple[Exchange, ...]
"""The latest exchanges, oldest first."""


def exchanged(bus: "Bus", question: ClockQuestion) -> tuple[Exchange, ClockAnswer] | None:
    """One question to the room's clock; None where no answer comes in time."""
    sent_s = time.monotonic()
    answer = bus.ask(question, ClockAnswer, ASK_S)
    if answer is None:
        return None
    return Exchange(sent_s, answer.now_s, time.monotonic()), answer


def asked(bus: "Bus") -> Offset:
    """The room's clock minus this host's, measured now; 0 where no answer comes."""
    state, offset = init(), Offset(0.0, 0.0)
    for _ in range(EXCHANGES):
        told = exchanged(bus, ClockQuestion())
        if told is None:
            break
        state, offset = step(state, told[0])
    return offset


@contextmanager
def followed(bus: "Bus", tell: Callable[[float], None], again_s: float = AGAIN_S) -> Iterator[None]:
    """Measure the offset again and again in a thread, and pass on each new one: clocks drift.

    While there is no answer, as when the integrator is restarted, the last offset holds.
    """
    over = threading.Event()

    def follow() -> None:
        state = init()
        while not over.wait(again_s):
            told = exchanged(bus, ClockQuestion())
            if told is None:
                continue
            state, offset = step(state, told[0])
            if len(state) >= EXCHANGES:
                tell(offset.offset_s)

    thread = threading.Thread(target=follow, name="the room's clock", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def init() -> State:
    """No exchange yet."""
    return ()


def step(state: State, exchange: Exchange) -> tuple[State, Offset]:
    """Add an exchange, and return the offset that is now believed.

    The answer was sent at some moment between question and receipt. Taking the middle errs by half
    the round trip at most, so the exchange with the shortest round trip is believed.
    """
    state = (*state, exchange)[-HISTORY:]
    best = min(state, key=lambda one: one.round_trip_s)
    middle_s = (best.sent_s + best.received_s) / 2
    return state, Offset(best.room_s - middle_s, best.round_trip_s / 2)
