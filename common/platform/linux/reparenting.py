"""Parts that are forked of a zygote and become children of the supervisor that owns it.

A fork ends with its parent, and only the parent learns how it ended. So the zygote's fork forks
once more and exits: Linux gives the orphan to its next ancestor that adopts orphans. The zygote may
then die without affecting a part.
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
"""prctl(2): orphaned descendants of this process become its children."""
BORN_S: Final = 20.0
"""Time for a fork to report its number, seconds."""
LOOK_S: Final = 0.005


class ReparentedProcess:
    """A child that another process forked, with the interface of multiprocessing's for its
    supervisor."""

    def __init__(self, pid: int, born: BaseProcess | None = None) -> None:
        """It lives, or its exit code has not been read.

        Args:
            pid: Its number.
            born: The process that forked it; its pipe, whose end the child sees, is kept open.
        """
        self.pid = pid
        self._born = born
        self._code: int | None = None

    @property
    def exitcode(self) -> int | None:
        """None while it lives; negative the signal that killed it."""
        if self._code is None:
            with suppress(ChildProcessError):  # its parent has not exited yet
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
        if self.is_alive():  # its number stays reserved until its exit code is read
            os.kill(self.pid, number)


@contextmanager
def adopting() -> Iterator[None]:
    """Inside this context orphaned descendants become this process's children.

    Not outside it: a decoder whose zygote dies goes to the machine's first process.
    """
    prctl = ctypes.CDLL(None).prctl
    try:
        prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        yield
    finally:
        prctl(PR_SET_CHILD_SUBREAPER, 0, 0, 0, 0)


def adopted(born: BaseProcess, words: Connection) -> ReparentedProcess:
    """The part that a zygote's fork leaves behind; this process has been `adopting` since before
    that fork.

    Args:
        born: The zygote's fork.
        words: Connection with the part's number.

    Raises:
        EOFError: When the fork died before it sent that.
        TimeoutError: When it did not send it in time; it is killed.
    """
    if not words.poll(BORN_S):
        born.kill()
        raise TimeoutError(f"no fork in {BORN_S:g} s")
    one = ReparentedProcess(int(words.recv()), born)
    born.join(BORN_S)
    return one


def be_adopted(words: Connection) -> None:
    """Continue as a child of the process that started this one, of which it is no fork, and which
    is `adopting`.

    No thread may have begun.

    Args:
        words: Connection on which the process sends its new number.
    """
    before = os.getpid()
    pid = os.fork()
    if pid:
        words.send(pid)
        os._exit(0)
    while os.getppid() == before:
        time.sleep(LOOK_S)
