"""The end of a process whose parent has died: nothing of a run outlives who started it."""

import ctypes
import multiprocessing
import os
import select
import signal
import sys
import threading
from collections.abc import Callable
from typing import Final

PR_SET_PDEATHSIG: Final = 1
"""prctl(2): the signal that Linux sends to a process when the thread that started it is gone."""
ORPHANED: Final = 1
"""Exit code of who ends so; nobody is left to read it."""


def end_with_parent() -> None:
    """End at once when the process that started this one by multiprocessing dies, however it does.

    Linux kills it, also while it is stopped or holds the interpreter; elsewhere a thread sees the
    end of a pipe. In a process that nobody started so nothing happens.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    if sys.platform == "linux":
        end_with(parent.pid or 0)
    _end_after(parent.join)


def end_with(starter: int) -> None:
    """Let Linux kill this process when the one that started it, by its number, dies."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != starter:  # it died before that was asked for
        os._exit(ORPHANED)


def end_with_pipe(number: int) -> None:
    """End at once when nobody can write any more into a pipe that this process reads.

    A thread of the parent may start this process and end before it, which Linux's own signal would
    take for the parent's death: so what threads start ends by its pipe.

    Args:
        number: Of the open file.
    """
    hung_up = select.poll()
    hung_up.register(number, 0)  # no events but the end, which is always told
    _end_after(hung_up.poll)


def _end_after(wait: Callable[[], object]) -> None:
    def end() -> None:
        wait()
        os._exit(ORPHANED)

    threading.Thread(target=end, name="parent's death", daemon=True).start()
