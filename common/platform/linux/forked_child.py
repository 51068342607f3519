"""A child process forked of the process that this one was forked of: it starts loaded, and shares
memory.

Where this process is a part of a run, its zygote (`zygote.py`) exists and can fork others too: a
process with threads must not fork itself.
"""

import multiprocessing
import os
import subprocess
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from typing import Any, Final

from common.platform.linux.own_process import hear_sigterm
from common.platform.linux.run_child import run

FORK: Final = multiprocessing.get_context("forkserver")


class ForkedChild:
    """A Python module in a fork, with the interface of `subprocess.Popen` for its starter."""

    def __init__(self, module: str, requests: int, answers: int) -> None:
        """Start it.

        Args:
            module: See `run_child.run`.
            requests: Open file that becomes its standard input.
            answers: Open file for its answers.
        """
        files = Connection(os.dup(requests), writable=False), Connection(os.dup(answers))
        self._process = FORK.Process(target=_run, args=(module, *files), daemon=True)
        self._process.start()
        for one in files:
            one.close()
        self.pid = self._process.pid or 0

    def kill(self) -> None:
        """End it, from any thread."""
        self._process.kill()

    def wait(self, timeout: float | None = None) -> int:
        """Its exit code, negative the signal that killed it.

        Raises:
            TimeoutExpired: When it lives on.
        """
        self._process.join(timeout)
        if self._process.exitcode is None:
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
        return self._process.exitcode


def can_fork() -> bool:
    """Whether this process was forked of one that forks others too, and may have children.

    multiprocessing looks only for a fork server that the process itself began. Without one it would
    start another, which would end this process with it; but the server that forked this process
    serves as well.
    """
    if forkserver.get_inherited_fds() is None or multiprocessing.current_process().daemon:
        return False
    server: Any = forkserver._forkserver
    if server._forkserver_pid is None:
        server.ensure_running = lambda: None
    return True


def _run(module: str, requests: Connection, answers: Connection) -> None:
    os.setpgrp()  # the signals of a run's group are not for it
    hear_sigterm()
    silence = os.open(os.devnull, os.O_WRONLY)
    for said in (1, 2):
        os.dup2(silence, said)
    os.dup2(requests.fileno(), 0)
    run(module, os.dup(answers.fileno()))
