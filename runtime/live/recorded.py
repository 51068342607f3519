"""What a live run said, kept for what is written at its end: the newest as bytes, and the rest as
its journal has it."""

import math
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from itertools import islice, takewhile
from typing import Final, Generic, TypeVar

from common.bus.message_codec import Said, decode, encode
from common.bus.messages import Body, Posture
from runtime.moved_facts import Moves, step

Told = TypeVar("Told", bound=Body | Posture)

MOST_KEPT: Final = 9_000
"""Ten minutes at 15 frames a second. A body takes 3 kB so, and five times as much as an object;
what is older is in the journal."""


class MessageLog(Generic[Said]):
    """The newest messages of one kind; the oldest give way, counted."""

    def __init__(self, kind: type[Said], most: int = MOST_KEPT) -> None:
        """None yet; at most so many."""
        self.let_go = 0
        """How many gave way."""
        self._kind = kind
        self._packed: deque[bytes] = deque(maxlen=most)

    def add(self, messages: Iterable[Said]) -> None:
        """Keep these too."""
        for message in messages:
            self.let_go += len(self._packed) == self._packed.maxlen
            self._packed.append(encode(message))

    def __iter__(self) -> Iterator[Said]:
        """What is kept, oldest first."""
        return (decode(packed, self._kind) for packed in self._packed)

    def newest(self, wanted: Callable[[Said], bool], most: int = MOST_KEPT) -> list[Said]:
        """The newest ones that are wanted, oldest first, up to the first that is not."""
        messages = (decode(packed, self._kind) for packed in islice(reversed(self._packed), most))
        return list(takewhile(wanted, messages))[::-1]


class WholeRun(Generic[Told]):
    """All that was said of one kind: what gave way in memory is read from the journal, each time
    that it is gone through."""

    def __init__(
        self, newest: MessageLog[Told], written: Iterable[Told], since_s: float = -math.inf
    ) -> None:
        """Of what memory holds and of what the journal does, captured since then."""
        self._newest, self._written, self._since_s = newest, written, since_s

    def __iter__(self) -> Iterator[Told]:
        """Oldest first."""
        first = next(iter(self._newest), None)
        if first is not None and self._newest.let_go and first.captured_s > self._since_s:
            gone = takewhile(lambda one: one.captured_s < first.captured_s, self._written)
            yield from (one for one in gone if one.captured_s >= self._since_s)
        if math.isfinite(self._since_s):  # mostly a few of many
            yield from self._newest.newest(lambda one: one.captured_s >= self._since_s)
        else:
            yield from self._newest


class SoFar:
    """What a summary tells of bodies and postures, kept as they come."""

    def __init__(self, bodies: Iterable[Body] = (), postures: Iterable[Posture] = ()) -> None:
        """Of these, and of what comes."""
        self.moves: Moves = ()
        """Of cameras."""
        self.posture = ""
        """Of a whole clip: the last name given, by a window that saw most of it."""
        self.instants = 0
        """How many bodies came."""
        self.with_somebody = 0
        """... of them those of instants that show somebody."""
        self.take(bodies, postures)

    def take(self, bodies: Iterable[Body], postures: Iterable[Posture]) -> None:
        """These too."""
        for body in bodies:
            self.moves = step(self.moves, body)
            self.instants += 1
            self.with_somebody += body.status != "empty"
        for posture in postures:
            self.posture = posture.name or self.posture
