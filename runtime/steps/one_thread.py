"""Linear algebra by one thread while steps go on: the same bits anywhere, and no waiting."""

from contextlib import ExitStack
from functools import cached_property
from threading import Lock
from typing import Final

from threadpoolctl import ThreadpoolController


class OneThread:
    """Limits the libraries of this process while it is entered, by however many threads.

    The first who enters limits them, the last who leaves sets them back: limits that overlap
    without being nested would set back each other's.
    """

    def __init__(self) -> None:
        """Nobody has entered."""
        self._lock = Lock()
        self._inside = 0
        self._limits = ExitStack()

    @cached_property
    def _libraries(self) -> ThreadpoolController:
        """Found once: that takes milliseconds, a limit microseconds."""
        return ThreadpoolController()

    def __enter__(self) -> None:
        """Limit them."""
        with self._lock:
            if not self._inside:
                self._limits.enter_context(self._libraries.limit(limits=1))
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        """Set them back."""
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._limits.close()


ONE_THREAD: Final = OneThread()
"""Of this process."""
