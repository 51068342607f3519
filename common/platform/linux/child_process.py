"""A Python module as a child process: bounded waits, and a message about its death."""

import contextlib
import fcntl
import io
import mmap
import os
import select
import signal
import subprocess
import sys
import time
from os import memfd_create
from typing import Final

import numpy as np

from common.platform.linux.forked_child import ForkedChild, can_fork
from common.platform.platform import Broken, Picture, how_it_ended
from common.platform.spawning import OF_TERMINALS

RUN: Final = f"{__package__}.run_child"
PIPE_BYTES: Final = 1 << 20
"""Buffer of a child's pipe, bytes: 18 pictures of 160x120, or as much as Linux grants."""

END_S: Final = 1.0
"""Time for a child to end after it closed its pipe, seconds."""


class ChildProcess:
    """A process that answers lines with bytes; see `Child`.

    Its arguments are the numbers of its answer pipe and of the picture's memory. It ignores the
    terminal's signals, even while it imports: Ctrl-C must not look like a broken video.
    """

    def __init__(
        self, module: str, stall_s: float, picture_size: tuple[int, int] | None = None
    ) -> None:
        """Start it; see `Platform.child`."""
        self._stall_s = stall_s
        self.picture: Picture | None = None
        # A pipe of its own: libraries' printed output must not mix with answers.
        read_end, write_end = os.pipe()
        heard, asked = os.pipe()
        self._requests = io.FileIO(asked, "w")
        if picture_size is None:
            self._process = _begun(module, heard, write_end)
        else:
            memory, self.picture = _shared(picture_size)
            shape = (memory, *self.picture.shape[:2])
            self._process = _executed(module, heard, write_end, shape)
            os.close(memory)
        os.close(heard)
        os.close(write_end)
        os.set_blocking(read_end, False)
        self._answers = io.FileIO(read_end)
        self._poll = select.poll()
        self._poll.register(self._answers, select.POLLIN)
        with contextlib.suppress(OSError):
            fcntl.fcntl(self._answers, fcntl.F_SETPIPE_SZ, PIPE_BYTES)

    @property
    def pid(self) -> int:
        """Its process number."""
        return self._process.pid

    def ask(self, request: bytes) -> None:
        """Send one line.

        Raises:
            Broken: When it died.
        """
        try:
            self._requests.write(request + b"\n")
        except BrokenPipeError as error:
            raise Broken(self._last_words()) from error

    def read_into(self, buffer: memoryview) -> None:
        """Fill `buffer`, plain bytes, with its answer.

        Raises:
            Broken: When it died or was stuck before that.
        """
        until_s = time.monotonic() + self._stall_s
        while buffer:
            got = self._answers.readinto(buffer)
            if got == 0:
                raise Broken(self._last_words())
            if got is not None:
                buffer = buffer[got:]
            elif not self._poll.poll(max(0.0, 1000 * (until_s - time.monotonic()))):
                self.kill()
                raise Broken(f"it gave nothing for {self._stall_s:g} s")

    def answers_within(self, wait_s: float) -> bool:
        """Whether something can be read in time: an answer, or its death."""
        return bool(self._poll.poll(max(0.0, 1000 * wait_s)))

    def kill(self) -> None:
        """End it, from any thread; a reading thread then gets Broken."""
        self._process.kill()

    def close(self) -> None:
        """End it and close its pipes."""
        self.kill()
        self._process.wait()
        self._requests.close()
        self._answers.close()
        self.picture = None

    def _last_words(self) -> str:
        try:
            code = self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self.kill()
            return "it closed its pipe"
        return how_it_ended(code)


def _shared(size: tuple[int, int]) -> tuple[int, Picture]:
    """Memory for a picture of (width, height): an open file's number, and the picture in it."""
    width, height = size
    memory = memfd_create("picture")
    os.truncate(memory, 3 * width * height)
    shared = mmap.mmap(memory, 3 * width * height)
    return memory, np.frombuffer(shared, np.uint8).reshape(height, width, 3)


def _begun(module: str, requests: int, answers: int) -> ForkedChild | subprocess.Popen[bytes]:
    """The module, forked where a forking process exists and lives."""
    if can_fork():
        with contextlib.suppress(OSError, EOFError):
            return ForkedChild(module, requests, answers)
    return _executed(module, requests, answers)


def _executed(
    module: str, requests: int, answers: int, picture: tuple[int, ...] = ()
) -> subprocess.Popen[bytes]:
    """The module in a new Python, given the memory, height and width of a picture."""
    # Its own group is too late for a Ctrl-C that comes while it is being forked.
    heard = signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
    try:
        # -P: another numpy.py in the working directory must not run.
        return subprocess.Popen(
            [sys.executable, "-P", "-m", RUN, module, *map(str, (answers, *picture))],
            stdin=requests,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=[answers, *picture[:1]],
            process_group=0,
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, heard)
