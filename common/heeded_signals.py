"""Signals that end a process in order."""

import _thread
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType


@contextmanager
def heeding(heed: Callable[[int], None], *numbers: int) -> Iterator[None]:
    """Inside this context each of these signals calls `heed` with its number, in another thread.

    Python runs a handler in the main thread between any two instructions, also inside `wait` or
    `set` of the very event that `heed` sets. The lock of an event is not reentrant, so the main
    thread would wait for itself. To be entered in the main thread alone.
    """

    def hand_on(number: int, _frame: FrameType | None) -> None:
        with suppress(RuntimeError):  # no thread begins while Python ends
            _thread.start_new_thread(heed, (number,))

    before = {number: signal.signal(number, hand_on) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
