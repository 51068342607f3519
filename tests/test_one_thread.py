"""Linear algebra by one thread, and by as many as before when all are done."""

import threading

from threadpoolctl import threadpool_info, threadpool_limits

from runtime.steps.one_thread import OneThread


def threads() -> set[int]:
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


def test_the_last_of_two_that_overlap_sets_the_threads_back() -> None:
    """Limits of two threads that are not nested would leave one thread for good."""
    one = OneThread()
    first_left, second_in = threading.Event(), threading.Event()
    met = list[set[int]]()

    def second() -> None:
        with one:
            second_in.set()
            first_left.wait(5.0)
            met.append(threads())

    with threadpool_limits(2):
        before = threads()
        other = threading.Thread(target=second)
        with one:
            other.start()
            assert second_in.wait(5.0)
            met.append(threads())
        first_left.set()
        other.join()
        assert met == [{1}, {1}]
        assert threads() == before == {2}


def test_threads_are_set_back_after_an_error_and_steps_may_be_nested() -> None:
    one = OneThread()
    with threadpool_limits(2):
        try:
            with one, one:
                assert threads() == {1}
                raise KeyboardInterrupt
        except KeyboardInterrupt:
            pass
        assert threads() == {2}
