"""A child as a spawned process: messages on pipes, a picture in shared memory."""

import io
import os
import threading
import time
from importlib import import_module
from multiprocessing.connection import Connection
from multiprocessing.shared_memory import SharedMemory
from queue import SimpleQueue
from typing import Any, Final

import numpy as np

from common.platform.platform import Asker, Broken, Picture, how_it_ended
from common.platform.spawning import ORPHANED, SPAWN, spawn

END_S: Final = 1.0
"""Time for a child to end after it closed its pipe, seconds."""


class PortableChild:
    """See `Child`."""

    def __init__(
        self, module: str, stall_s: float, picture_size: tuple[int, int] | None = None
    ) -> None:
        """Start it; see `Platform.child`."""
        self._stall_s, self._left = stall_s, memoryview(b"")
        self._memory: SharedMemory | None = None
        self.picture: Picture | None = None
        shared: tuple[str, tuple[int, int]] | None = None
        if picture_size is not None:
            width, height = picture_size
            self._memory = SharedMemory(create=True, size=3 * width * height)
            self.picture = _picture(self._memory, picture_size)
            shared = self._memory.name, picture_size
        requests, self._requests = SPAWN.Pipe(duplex=False)
        self._answers, answers = SPAWN.Pipe(duplex=False)
        self._process = spawn(_run, (module, requests, answers, shared))
        requests.close()
        answers.close()

    @property
    def pid(self) -> int:
        """Its process number."""
        return self._process.pid or 0

    def ask(self, request: bytes) -> None:
        """Send one line.

        Raises:
            Broken: When it died.
        """
        try:
            self._requests.send_bytes(request)
        except OSError as error:
            raise Broken(self._last_words()) from error

    def read_into(self, buffer: memoryview) -> None:
        """Fill `buffer`, plain bytes, with its answer.

        Raises:
            Broken: When it died or was stuck before that.
        """
        until_s = time.monotonic() + self._stall_s
        while buffer:
            if not self._left:
                self._left = self._next(until_s)
            count = min(len(buffer), len(self._left))
            buffer[:count] = self._left[:count]
            buffer, self._left = buffer[count:], self._left[count:]

    def answers_within(self, wait_s: float) -> bool:
        """Whether something can be read in time: an answer, or its death."""
        return bool(self._left) or self._answers.poll(max(0.0, wait_s))

    def kill(self) -> None:
        """End it, from any thread; a reading thread then gets Broken."""
        self._process.kill()

    def close(self) -> None:
        """End it and release its pipes and the picture."""
        self.kill()
        self._process.join()
        self._requests.close()
        self._answers.close()
        self.picture = None
        if self._memory is not None:
            self._memory.close()
            self._memory.unlink()
            self._memory = None

    def _next(self, until_s: float) -> memoryview:
        """One message of its answers."""
        try:
            if self._answers.poll(max(0.0, until_s - time.monotonic())):
                return memoryview(self._answers.recv_bytes())
        except (EOFError, OSError) as error:
            raise Broken(self._last_words()) from error
        self.kill()
        raise Broken(f"it gave nothing for {self._stall_s:g} s")

    def _last_words(self) -> str:
        self._process.join(END_S)
        code = self._process.exitcode
        if code is None:
            self.kill()
            return "it closed its pipe"
        return how_it_ended(code)


class _Messages(io.RawIOBase):
    """A file whose pieces are messages."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe

    def writable(self) -> bool:
        return True

    def write(self, piece: Any) -> int:
        self._pipe.send_bytes(piece)
        return len(piece)


def _picture(memory: SharedMemory, size: tuple[int, int]) -> Picture:
    width, height = size
    return np.ndarray((height, width, 3), np.uint8, memory.buf)


def _run(
    module: str,
    requests: Connection,
    answers: Connection,
    shared: tuple[str, tuple[int, int]] | None,
) -> None:
    """Run the child."""
    silence = os.open(os.devnull, os.O_WRONLY)
    for said in (1, 2):
        os.dup2(silence, said)
    lines: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_hear, args=(requests, lines), name="ear", daemon=True).start()
    said_to = io.BufferedWriter(_Messages(answers))
    if shared is None:
        asker = Asker(iter(lines.get, None), said_to)
    else:
        name, size = shared
        memory = SharedMemory(name)
        asker = Asker(iter(lines.get, None), said_to, _picture(memory, size))
    import_module(module).main(asker)
    said_to.flush()


def _hear(requests: Connection, lines: "SimpleQueue[bytes]") -> None:
    """Receive requests; without an asker this process ends, whatever it does."""
    while True:
        try:
            lines.put(requests.recv_bytes())
        except (EOFError, OSError):
            os._exit(ORPHANED)
