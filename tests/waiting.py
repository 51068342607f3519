"""Waiting for what comes in its own time: until it is there, and not longer than is sensible."""

import time
from collections.abc import Callable
from typing import TypeVar

Answer = TypeVar("Answer")
PATIENCE_S = 60.0


def until(question: Callable[[], Answer], seconds: float = PATIENCE_S) -> Answer:
    """What a question gives once that is true, or in the end."""
    until_s = time.monotonic() + seconds
    while not (answer := question()) and time.monotonic() < until_s:
        time.sleep(0.02)
    return answer
