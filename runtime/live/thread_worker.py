"""Parts of a run as threads of one process, which halves a room's memory.

A crash of the process ends the whole room; the service restarts it.
"""

import logging
import os
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, Final

from common.bus.process import ProcessContext
from runtime.faults import code_of, told

KILLED: Final = 70
"""Exit code of a process with a hung thread: a thread cannot be killed alone."""


class ThreadWorker:
    """A part in a thread, with the interface of a process for its supervisor."""

    def __init__(
        self, name: str, main: Callable[..., None], arguments: tuple[Any, ...], words: Connection
    ) -> None:
        """Started now.

        Args:
            name: Name of the part.
            main: Its function.
            arguments: They include its context, which gets the part's stop event.
            words: Connection on which it reports its error.
        """
        self.exitcode: int | None = None
        """None while it runs."""
        self.pid = os.getpid()
        self._stop = threading.Event()
        own = tuple(
            each._replace(stop=self._stop) if isinstance(each, ProcessContext) else each
            for each in arguments
        )

        def work() -> None:
            try:
                main(*own)
                self.exitcode = 0
            except Exception as error:
                self.exitcode = confessed(name, error, words)

        self._thread = threading.Thread(target=work, name=name, daemon=True)
        self._thread.start()

    def is_alive(self) -> bool:
        """Whether it runs."""
        return self._thread.is_alive()

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, or that many seconds."""
        self._thread.join(timeout)

    def terminate(self) -> None:
        """Ask it to end."""
        self._stop.set()

    def kill(self) -> None:
        """End it, with its whole process: the measurements are in the run's journal."""
        if self.is_alive():
            os._exit(KILLED)


def confessed(name: str, error: Exception, words: Connection) -> int:
    """Report a part's error in one line, not in a traceback; the exit code."""
    logging.getLogger(name).debug("failed", exc_info=error)
    words.send(told(error))
    return code_of(error)
