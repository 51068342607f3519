"""A live run's messages, kept for its results: the newest in memory as bytes, the rest in the
journal."""

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
"""Messages in memory: ten minutes at 15 Hz. A body takes 3 kB as bytes, and five times as much
as an object."""


class MessageLog(Generic[Said]):
    """The newest messages of one kind; the oldest are dropped, counted."""

    def __init__(self, kind: type[Said], most: int = MOST_KEPT) -> None:
        """Empty; at most this many."""
        self.let_go = 0
        """Number dropped."""
        self._kind = kind
        self._packed: deque[bytes] = deque(maxlen=most)

    def add(self, messages: Iterable[Said]) -> None:
        """Add messages."""
        for message in messages:
            self.let_go += len(self._packed) == self._packed.maxlen
            self._packed.append(encode(message))

    def __iter__(self) -> Iterator[Said]:
        """The kept messages, oldest first."""
        return (decode(packed, self._kind) for packed in self._packed)

    def newest(self, wanted: Callable[[Said], bool], most: int = MOST_KEPT) -> list[Said]:
        """The newest ones up to the first unwanted one, oldest first."""
        messages = (decode(packed, self._kind) for packed in islice(reversed(self._packed), most))
        return list(takewhile(wanted, messages))[::-1]


class WholeRun(Generic[Told]):
    """All messages of one kind: those dropped from memory are read from the journal, at each
    iteration."""

    def __init__(
        self, newest: MessageLog[Told], written: Iterable[Told], since_s: float = -math.inf
    ) -> None:
        """Captured since a time, from memory and from the journal."""
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
    """Facts of bodies and postures for the summary, updated as they come."""

    def __init__(self, bodies: Iterable[Body] = (), postures: Iterable[Posture] = ()) -> None:
        """From these bodies, and from later ones."""
        self.moves: Moves = ()
        """The moves of cameras so far."""
        self.posture = ""
        """For a whole clip: the last name given, by a window that saw most of it."""
        self.postures: dict[int, str] = {}
        """The same by the number of each of several people."""
        self.instants = 0
        """Number of bodies."""
        self.with_person = 0
        """... and of those in instants with a person."""
        self.take(bodies, postures)

    def take(self, bodies: Iterable[Body], postures: Iterable[Posture]) -> None:
        """Add bodies."""
        for body in bodies:
            self.moves = step(self.moves, body)
            self.instants += 1
            self.with_person += body.status != "empty"
        for posture in postures:
            self.posture = posture.name or self.posture
            if posture.person and posture.name:
                self.postures[posture.person] = posture.name
