"""A new Python by multiprocessing's public means, deaf to what a terminal says to all processes."""

import multiprocessing
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, Final

from common.platform.environment import handed_down

SPAWN: Final[SpawnContext] = multiprocessing.get_context("spawn")
ORPHANED: Final = 1
"""Exit code of a process whose starter died; no process is left to read it."""
OF_TERMINALS: Final = [
    getattr(signal, name) for name in ("SIGINT", "SIGHUP") if hasattr(signal, name)
]
SAFE: Final = {"PYTHONSAFEPATH": "1"}
"""A stranger's numpy.py in the working directory is not ours to run."""


def spawn(
    target: Callable[..., None],
    arguments: tuple[Any, ...],
    nests: bool = False,
    variables: Mapping[str, str] = SAFE,
) -> SpawnProcess:
    """Begin a process that calls `target`.

    Args:
        target: Found by its name in the new process.
        arguments: Of the call; they are pickled.
        nests: It starts processes of its own.
        variables: Of its environment, beside this process's.
    """
    process = SPAWN.Process(target=target, args=arguments, daemon=not nests)
    with handed_down(variables), _deaf():
        process.start()
    return process


@contextmanager
def _deaf() -> Iterator[None]:
    """Meanwhile this process ignores what terminals say, and those that it starts do so for good,
    also while they import. Only the main thread can arrange that."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, signal.SIG_IGN) for number in OF_TERMINALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
