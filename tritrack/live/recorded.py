"""What a live run said, kept for what is written at its end: the newest, as bytes."""

from collections import deque
from collections.abc import Callable, Iterable
from itertools import islice, takewhile
from typing import Final, Generic

from common.bus.message_codec import Said, decode, encode

MOST_KEPT: Final = 54_000
"""An hour at 15 frames a second. A body takes 1.7 kB so, and five times as much as an object."""


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

    def all(self) -> list[Said]:
        """What is kept, oldest first."""
        return [decode(packed, self._kind) for packed in self._packed]

    def newest(self, wanted: Callable[[Said], bool], most: int = MOST_KEPT) -> list[Said]:
        """The newest ones that are wanted, oldest first, up to the first that is not."""
        messages = (decode(packed, self._kind) for packed in islice(reversed(self._packed), most))
        return list(takewhile(wanted, messages))[::-1]
