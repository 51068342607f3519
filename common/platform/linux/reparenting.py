"""Parts that are forked of a zygote and become children of the supervisor whose zygote that is.

A fork ends with who forked it, and only that process learns how it ended. So the fork of a zygote
forks once more and is gone: Linux gives the orphan to its next ancestor that takes such in. The
zygote may die then without a part noticing.
"""

import ctypes
import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Final

PR_SET_CHILD_SUBREAPER: Final = 36
"""prctl(2): orphans among who descends from this process become its children."""
BORN_S: Final = 20.0
"""A fork that has not said its number by then never will."""
LOOK_S: Final = 0.005


class ReparentedProcess:
    """A child that another process forked; to its supervisor what multiprocessing's would be."""

    def __init__(self, pid: int, born: BaseProcess | None = None) -> None:
        """It lives, or its end has not been asked for.

        Args:
            pid: Its number.
            born: Who left it behind; its pipe, of which the child sees the end, is kept open.
        """
        self.pid = pid
        self._born = born
        self._code: int | None = None

    @property
    def exitcode(self) -> int | None:
        """None while it lives; negative the signal that killed it."""
        if self._code is None:
            with suppress(ChildProcessError):  # who left it behind is not gone yet
                number, status = os.waitpid(self.pid, os.WNOHANG)
                self._code = os.waitstatus_to_exitcode(status) if number else None
        return self._code

    def is_alive(self) -> bool:
        """Whether it lives."""
        return self.exitcode is None

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, or so many seconds."""
        until_s = None if timeout is None else time.monotonic() + timeout
        while self.is_alive() and (until_s is None or time.monotonic() < until_s):
            time.sleep(LOOK_S)

    def terminate(self) -> None:
        """Ask it to end."""
        self._tell(signal.SIGTERM)

    def kill(self) -> None:
        """End it."""
        self._tell(signal.SIGKILL)

    def _tell(self, number: signal.Signals) -> None:
        if self.is_alive():  # until its end is asked for its number is nobody else's
            os.kill(self.pid, number)


@contextmanager
def adopting() -> Iterator[None]:
    """Meanwhile orphans among who descends from this process become its children.

    Not for longer: a decoder whose zygote dies is left to the machine's first process.
    """
    prctl = ctypes.CDLL(None).prctl
    try:
        prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        yield
    finally:
        prctl(PR_SET_CHILD_SUBREAPER, 0, 0, 0, 0)


def adopted(born: BaseProcess, words: Connection) -> ReparentedProcess:
    """The part that a zygote's fork leaves behind; `adopting` since before that was started.

    Args:
        born: The zygote's fork.
        words: On which it says the part's number.

    Raises:
        EOFError: When it died before it said that.
        TimeoutError: When it did not say it in time; it is killed.
    """
    if not words.poll(BORN_S):
        born.kill()
        raise TimeoutError(f"no fork in {BORN_S:g} s")
    one = ReparentedProcess(int(words.recv()), born)
    born.join(BORN_S)
    return one


def be_adopted(words: Connection) -> None:
    """Go on as the child of who started this process, of which it is no fork, and is `adopting`.

    No thread may have begun.

    Args:
        words: On which the number is said that this process has from then on.
    """
    before = os.getpid()
    pid = os.fork()
    if pid:
        words.send(pid)
        os._exit(0)
    while os.getppid() == before:
        time.sleep(LOOK_S)
