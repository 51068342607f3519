"""Parts of a run that are threads of one process: a room takes half the memory so.

What breaks the process ends all of the room; who serves it starts it again.
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
"""Exit code of a process of which a thread hangs: no thread can be killed alone."""


class ThreadWorker:
    """A part in a thread; to its supervisor what a process of its own would be."""

    def __init__(
        self, name: str, main: Callable[..., None], arguments: tuple[Any, ...], words: Connection
    ) -> None:
        """Begun now.

        Args:
            name: Of the part.
            main: What it does.
            arguments: Its context among them is told how this part is ended.
            words: On which it says why it fails.
        """
        self.exitcode: int | None = None
        """None while it works."""
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
        """Whether it works."""
        return self._thread.is_alive()

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, or so many seconds."""
        self._thread.join(timeout)

    def terminate(self) -> None:
        """Ask it to end."""
        self._stop.set()

    def kill(self) -> None:
        """End it, and all of its process: what was measured is in the run's journal."""
        if self.is_alive():
            os._exit(KILLED)


def confessed(name: str, error: Exception, words: Connection) -> int:
    """Say in one line, not in a traceback, what a part cannot do; the exit code of that."""
    logging.getLogger(name).debug("failed", exc_info=error)
    words.send(told(error))
    return code_of(error)
