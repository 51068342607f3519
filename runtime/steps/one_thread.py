"""Linear algebra by one thread while steps go on: the same bits anywhere, and no waiting."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import RLock
from typing import Final

from threadpoolctl import ThreadpoolController

TURN: Final = RLock()


@contextmanager
def one_thread() -> Iterator[None]:
    """Limits the libraries of this process; its threads take turns.

    OpenBLAS gets its threads back only from the thread that took them: limits of two threads that
    overlap would leave the program one for good.
    """
    with TURN, _libraries().limit(limits=1):
        yield


@cache
def _libraries() -> ThreadpoolController:
    """Found once: that takes milliseconds, a limit microseconds."""
    return ThreadpoolController()
