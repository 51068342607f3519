"""Single-threaded linear algebra during steps: the same bits everywhere, and no waiting."""

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

    Only the thread that limited OpenBLAS can restore its threads: overlapping limits of two threads
    would leave the program with one for good.
    """
    with TURN, _libraries().limit(limits=1):
        yield


@cache
def _libraries() -> ThreadpoolController:
    """Found once: that takes milliseconds, a limit microseconds."""
    return ThreadpoolController()
