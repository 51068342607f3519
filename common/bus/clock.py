"""The room's clock as another host sees it: questions, answers, the quickest of them believed."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, NamedTuple

from common.bus.control_messages import ClockAnswer, ClockQuestion

if TYPE_CHECKING:
    from common.bus.bus import Bus

ASK_S: Final = 0.5
"""How long an answer is waited for."""
EXCHANGES: Final = 5
"""As many are enough to begin with."""

AGAIN_S: Final = 2.0
"""How long it is from one question to the next while a run goes on."""
HISTORY: Final = 32
"""How many exchanges are remembered: few enough that clocks do not drift apart meanwhile
(50 ppm make 3 ms in a minute of a question every AGAIN_S; in an hour 180)."""


class Exchange(NamedTuple):
    """One question and its answer."""

    sent_s: float
    """When the question left, by this host's clock."""
    room_s: float
    """What the room's clock said at the answer."""
    received_s: float
    """When the answer came, by this host's clock."""

    @property
    def round_trip_s(self) -> float:
        """How long it took there and back."""
        return self.received_s - self.sent_s


class Offset(NamedTuple):
    """What to add to this host's clock to read the room's."""

    offset_s: float
    error_s: float
    """It is at most this far off: half the round trip."""


State = tuple[Exchange, ...]
"""The exchanges of late, oldest first."""


def exchanged(bus: "Bus", question: ClockQuestion) -> tuple[Exchange, ClockAnswer] | None:
    """One question to the room's clock; None where nobody answers in time."""
    sent_s = time.monotonic()
    answer = bus.ask(question, ClockAnswer, ASK_S)
    if answer is None:
        return None
    return Exchange(sent_s, answer.now_s, time.monotonic()), answer


def asked(bus: "Bus") -> Offset:
    """How far the room's clock is from this host's, asked now; 0 where nobody answers."""
    state, offset = init(), Offset(0.0, 0.0)
    for _ in range(EXCHANGES):
        told = exchanged(bus, ClockQuestion())
        if told is None:
            break
        state, offset = step(state, told[0])
    return offset


@contextmanager
def followed(bus: "Bus", tell: Callable[[float], None], again_s: float = AGAIN_S) -> Iterator[None]:
    """Ask on in a thread, and tell each new offset: two hosts' clocks drift apart.

    While nobody answers, as where the integrator is started again, the last one holds.
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
    """Nothing was asked yet."""
    return ()


def step(state: State, exchange: Exchange) -> tuple[State, Offset]:
    """Take an exchange in; say what is now believed.

    The answer was given somewhere between question and receipt; in the middle is the guess that
    errs by half the round trip at most, so the exchange with the least round trip is believed.
    """
    state = (*state, exchange)[-HISTORY:]
    best = min(state, key=lambda one: one.round_trip_s)
    middle_s = (best.sent_s + best.received_s) / 2
    return state, Offset(best.room_s - middle_s, best.round_trip_s / 2)
