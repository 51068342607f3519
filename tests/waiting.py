"""Waiting for what comes in its own time: until it is there, and not longer than is sensible."""

import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

Answer = TypeVar("Answer")
PATIENCE_S = 60.0
LONG_S = 180.0
"""For a process on a busy machine: it imports all and compiles nothing."""


def until(question: Callable[[], Answer], seconds: float = PATIENCE_S) -> Answer:
    """What a question gives once that is true, or in the end."""
    until_s = time.monotonic() + seconds
    while not (answer := question()) and time.monotonic() < until_s:
        time.sleep(0.02)
    return answer


def until_of(process: "subprocess.Popen[str]", question: Callable[[], Answer], log: Path) -> Answer:
    """What a question gives once that is true, while a process runs of which that comes.

    Raises:
        AssertionError: When the process ended before, or it took too long; with what it said, and
            what stands in its log.
    """
    answer = until(lambda: question() or process.poll() is not None, LONG_S) and question()
    if not answer:
        ended = process.poll()
        process.kill()
        said = "".join(part or "" for part in process.communicate())
        said += log.read_text() if log.is_file() else "no log"
        raise AssertionError(f"it {'runs' if ended is None else f'ended with {ended}'}: {said}")
    return answer
