"""Settings of a process for itself: its name, its end with its parent, its signals."""

import ctypes
import multiprocessing
import os
import select
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

PR_SET_PDEATHSIG: Final = 1
"""prctl(2): the signal that Linux sends to a process when its starting thread ends."""
ORPHANED: Final = 1
"""Exit code of a process that ends so; no process reads it."""


def be_shown_as(name: str) -> None:
    """Give this process the name that `top` and `ps` show, cut to 15 letters."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name)


def hear_sigterm() -> None:
    """Unblock SIGTERM, which a zygote blocks for its forks until they can handle it."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGTERM,))


def end_with_parent() -> None:
    """End at once when the process that started this one by multiprocessing dies in any way.

    When the starting thread ends, Linux kills this process, even while it is stopped or holds the
    interpreter; a watching thread sees the end of the parent's pipe. In a process that was not
    started so nothing happens.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    end_with(parent.pid or 0)
    _end_after(parent.join)


def end_with(starter: int) -> None:
    """Let Linux kill this process when its starter, given by number, dies."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != starter:  # it died before this call
        os._exit(ORPHANED)


def end_with_pipe(number: int) -> None:
    """End at once when no process can write any more into a pipe that this process reads.

    A parent's thread may start this process and end before it, which Linux's own signal would take
    for the parent's death: so the children of threads end by their pipe.

    Args:
        number: Number of the open file.
    """
    hung_up = select.poll()
    hung_up.register(number, 0)  # no events but the end, which is always reported
    _end_after(hung_up.poll)


def _end_after(wait: Callable[[], object]) -> None:
    def end() -> None:
        wait()
        os._exit(ORPHANED)

    threading.Thread(target=end, name="parent's death", daemon=True).start()
