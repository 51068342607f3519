"""Signals that end a process in order."""

import os
import signal
import threading

from common.heeded_signals import heeding

SOON_S = 5.0


def test_a_signal_is_heeded_while_the_main_thread_holds_what_it_needs() -> None:
    """A handler that took the lock itself would wait for the thread that it interrupted."""
    lock, heard = threading.Lock(), threading.Event()

    def heed(_number: int) -> None:
        if lock.acquire(timeout=SOON_S):
            heard.set()

    with heeding(heed, signal.SIGTERM):
        with lock:
            for _ in range(2):
                os.kill(os.getpid(), signal.SIGTERM)
        assert heard.wait(SOON_S)


def test_each_signal_is_named_and_afterwards_is_what_it_was() -> None:
    heard: list[int] = []
    both = threading.Semaphore(0)

    def heed(number: int) -> None:
        heard.append(number)
        both.release()

    before = signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)
    with heeding(heed, signal.SIGTERM, signal.SIGINT):
        for number in (signal.SIGTERM, signal.SIGINT):
            os.kill(os.getpid(), number)
            assert both.acquire(timeout=SOON_S)
    assert heard == [signal.SIGTERM, signal.SIGINT]
    assert (signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)) == before
