"""A bounded queue between a receiving and a working thread: the oldest item is dropped and
counted."""

import itertools
import threading
from collections.abc import Hashable
from typing import Generic, TypeVar

Item = TypeVar("Item")


class Mailbox(Generic[Item]):
    """Items received and not taken yet, oldest first; putting never blocks."""

    def __init__(self, bound: int) -> None:
        """At most `bound` items wait; one more drops the oldest."""
        self.dropped = 0
        """Number of items dropped before they were taken."""
        self._bound = bound
        self._waiting: dict[Hashable, Item] = {}
        self._numbers = itertools.count()
        self._changed = threading.Condition()
        self._closed = False

    def put(self, item: Item, slot: str | None = None) -> None:
        """Add an item; a closed mailbox ignores it.

        An item with a slot replaces the waiting item of that slot. Such a replacement is not
        counted: a slot means that only the newest item matters.
        """
        with self._changed:
            if self._closed:
                return
            if slot is not None:
                self._waiting.pop(slot, None)
            if len(self._waiting) == self._bound:
                del self._waiting[next(iter(self._waiting))]
                self.dropped += 1
            self._waiting[next(self._numbers) if slot is None else slot] = item
            self._changed.notify()

    def take(self, timeout_s: float) -> Item | None:
        """The oldest item; None when none comes in time, or when the mailbox is closed and
        empty."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._closed, timeout_s)
            return self._waiting.pop(next(iter(self._waiting))) if self._waiting else None

    def drain(self) -> list[Item]:
        """All that waits, oldest first."""
        with self._changed:
            items = list(self._waiting.values())
            self._waiting.clear()
            return items

    def close(self) -> None:
        """Accept nothing more and wake the waiting threads; waiting items can still be taken."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    @property
    def over(self) -> bool:
        """True when it is closed and everything was taken."""
        with self._changed:
            return self._closed and not self._waiting
