"""A worker as a spawned process: a pipe asks it to end, and it ends when the pipe does."""

import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Final

from common.platform.environment import FRUGAL
from common.platform.platform import COMPILED_S, WARM_S, Job, Started, Worker
from common.platform.spawning import ORPHANED, SAFE, SPAWN, spawn

LOOK_S: Final = 0.05


class PortableWorker:
    """See `Worker`."""

    def __init__(self, process: BaseProcess, asks: Connection) -> None:
        """It was started.

        Args:
            process: Its process.
            asks: Connection that asks it to end.
        """
        self._process, self._asks = process, asks

    @property
    def pid(self) -> int | None:
        """Its process number."""
        return self._process.pid

    @property
    def exitcode(self) -> int | None:
        """None while it lives."""
        return self._process.exitcode

    def is_alive(self) -> bool:
        """Whether it lives."""
        return self._process.is_alive()

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, or so many seconds."""
        self._process.join(timeout)

    def terminate(self) -> None:
        """Ask it to end."""
        with suppress(OSError):  # it has ended
            self._asks.send_bytes(b"end")

    def kill(self) -> None:
        """End it."""
        self._process.kill()


class Ear:
    """Receives the request to end, and the end of the starter."""

    def __init__(self) -> None:
        """Not receiving yet: the process ends at once when it is asked to."""
        self._end: Callable[[], None] | None = None

    def open(self, asks: Connection) -> None:
        """Receive from now on."""
        threading.Thread(target=self._hear, args=(asks,), name="ear", daemon=True).start()

    @contextmanager
    def listening(self, end: Callable[[], None]) -> Iterator[None]:
        """Inside this context `end` is called when this process is asked to end."""
        before, self._end = self._end, end
        try:
            yield
        finally:
            self._end = before

    def _hear(self, asks: Connection) -> None:
        while True:
            try:
                asks.recv_bytes()
            except (EOFError, OSError):
                os._exit(ORPHANED)
            if self._end is None:
                os._exit(0)
            self._end()


EAR: Final = Ear()
"""This process's own; closed where it is no worker."""


class PortableLauncher:
    """See `Launcher`: each worker imports separately, but none compiles."""

    def __init__(self, loaded: str) -> None:
        """Where compilation is missing, a worker that loads the module does it from now on."""
        from common.cache_folder import mark_of_all

        job = Job("compiling", _load, (loaded,), nests=True)
        self._compiling: Worker | None = None if mark_of_all().exists() else spawned(job).worker

    def wait(self, stop: threading.Event, look: Callable[[], None], most_s: float = WARM_S) -> None:
        """Wait until everything is compiled, or that takes too long, or `stop` is set."""
        until_s = time.monotonic() + max(most_s, COMPILED_S)
        while self._compiling is not None and self._compiling.is_alive():
            if stop.wait(LOOK_S) or time.monotonic() > until_s:
                self._compiling.kill()
            look()

    def ready(self) -> bool:
        """Always."""
        return True

    def start(self, job: Job) -> Started:
        """Begin a worker."""
        return spawned(job)


def spawned(job: Job) -> Started:
    """A started worker."""
    ours, words = SPAWN.Pipe(duplex=False)
    asked, asks = SPAWN.Pipe(duplex=False)
    process = spawn(_run, (job.main, job.arguments, words, asked), job.nests, {**SAFE, **FRUGAL})
    words.close()
    asked.close()
    return Started(PortableWorker(process, asks), ours)


def _run(
    main: Callable[..., None], arguments: tuple[Any, ...], words: Connection, asked: Connection
) -> None:
    EAR.open(asked)
    main(*arguments, words)


def _load(loaded: str, _words: Connection) -> None:
    import_module(loaded)
