"""A new Python by multiprocessing's public means, without a terminal's signals."""

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
"""Exit code of a process whose starter died; no process reads it."""
OF_TERMINALS: Final = [
    getattr(signal, name) for name in ("SIGINT", "SIGHUP") if hasattr(signal, name)
]
SAFE: Final = {"PYTHONSAFEPATH": "1"}
"""Environment variables with which a numpy.py in the working directory does not run."""


def spawn(
    target: Callable[..., None],
    arguments: tuple[Any, ...],
    nests: bool = False,
    variables: Mapping[str, str] = SAFE,
) -> SpawnProcess:
    """Begin a process that calls `target`.

    Args:
        target: Imported by name in the new process.
        arguments: Arguments of the call; they are pickled.
        nests: It starts processes of its own.
        variables: Additions to this process's environment.
    """
    process = SPAWN.Process(target=target, args=arguments, daemon=not nests)
    with handed_down(variables), _deaf():
        process.start()
    return process


@contextmanager
def _deaf() -> Iterator[None]:
    """Inside this context this process ignores a terminal's signals; processes that it starts
    ignore them permanently, even while they import. Only the main thread can do that."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, signal.SIG_IGN) for number in OF_TERMINALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
