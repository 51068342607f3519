"""Slow questions, answered one after the other in a thread, while the page is served."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

from common.video.decoding import Decoder

Answer = TypeVar("Answer")


class Aside:
    """A thread with a decoder of its own, until `close`."""

    def __init__(self) -> None:
        self._decoder = Decoder()
        self._thread = ThreadPoolExecutor(1)
        self._answers: dict[Future[Any], Callable[[Any], None]] = {}

    @property
    def is_free(self) -> bool:
        """Whether nothing waits for an answer."""
        return not self._answers

    def ask(self, question: Callable[[Decoder], Answer], keep: Callable[[Answer], None]) -> None:
        """Have a question answered; `keep` gets the answer in a later `turn`."""
        self._answers[self._thread.submit(question, self._decoder)] = keep

    def turn(self) -> None:
        """Hand out the answers that are there."""
        for done in [future for future in self._answers if future.done()]:
            self._answers.pop(done)(done.result())

    def close(self) -> None:
        """End the thread; what is not answered yet is let go."""
        self._decoder.stop()
        self._thread.shutdown(cancel_futures=True)
        self._decoder.close()
