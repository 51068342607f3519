"""Linear algebra by one thread, and by as many as before when all are done."""

import threading

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from runtime.steps.one_thread import one_thread

LOADED = np.linalg.inv(np.eye(2))
"""By a library with threads of its own."""


def threads() -> set[int]:
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


def test_threads_that_meet_take_turns_and_the_program_has_its_own_back() -> None:
    """Limits that overlap would leave one thread for good."""
    asks, came = threading.Event(), threading.Event()

    def second() -> None:
        asks.set()
        with one_thread():
            came.set()

    with threadpool_limits(2):
        other = threading.Thread(target=second)
        with one_thread():
            other.start()
            assert asks.wait(5.0)
            assert not came.wait(0.1)
            assert threads() == {1}
        other.join(5.0)
        assert came.is_set()
        assert threads() == {2}


def test_threads_are_set_back_after_an_error() -> None:
    with threadpool_limits(2):
        with pytest.raises(KeyboardInterrupt), one_thread(), one_thread():
            raise KeyboardInterrupt
        assert threads() == {2}
