"""A worker's process: a fork or a new Python, with few threads, without terminal signals."""

import multiprocessing
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from typing import Any, Final

from common.platform.environment import FRUGAL, handed_down
from common.platform.linux.forked_child import FORK
from common.platform.linux.own_process import be_shown_as, end_with_parent, hear_sigterm
from common.platform.linux.reparenting import adopted, adopting, be_adopted
from common.platform.platform import Job, Started
from common.platform.spawning import OF_TERMINALS

SPAWN: Final = multiprocessing.get_context("spawn")


def begun(job: Job, forked: bool) -> Started:
    """A worker, begun.

    Args:
        job: Its job.
        forked: Fork it of the zygote, which must exist; otherwise it is a new Python.

    Raises:
        EOFError, OSError: When the zygote dies meanwhile.
    """
    context = FORK if forked else SPAWN
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(
        name=job.name,
        target=_run,
        args=(job.name, job.main, job.arguments, theirs, forked),
        daemon=not job.nests,
    )
    with inherited(), adopting() if forked else nullcontext():
        process.start()
        theirs.close()
        return Started(adopted(process, ours) if forked else process, ours)


@contextmanager
def inherited() -> Iterator[None]:
    """Settings that a process inherits from its supervisor: one thread per library, one heap, no
    terminal signals.

    A terminal sends Ctrl-C and SIGHUP to all processes. Only the supervisor, which ends the others
    in order, may receive them, even while the others are still importing.
    """
    heard = signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
    try:
        with handed_down(FRUGAL):
            with deaf() if signal.SIGINT in heard else nullcontext():
                resource_tracker.ensure_running()  # blocked as well; its start unblocks SIGINT
            signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
            yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, heard)  # a site's run blocks them itself


@contextmanager
def deaf() -> Iterator[None]:
    """No Ctrl-C is heard, nor what came while it was blocked: for a process without terminal
    signals that starts another one. Python lets the main thread alone say so."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _run(
    name: str,
    main: Callable[..., None],
    arguments: tuple[Any, ...],
    words: Connection,
    forked: bool,
) -> None:
    if forked:
        be_adopted(words)
    be_shown_as(name)
    end_with_parent()
    hear_sigterm()
    main(*arguments, words)
