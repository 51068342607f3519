"""A worker's process: begun as a fork or as a new Python, frugal, deaf to its terminal."""

import multiprocessing
import signal
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

SPAWN: Final = multiprocessing.get_context("spawn")
OF_TERMINALS: Final = (signal.SIGINT, signal.SIGHUP)


def begun(job: Job, forked: bool) -> Started:
    """A worker, begun.

    Args:
        job: What it does.
        forked: Of the zygote, which must be there; else it is a new Python.

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
    """What a process takes over from its supervisor: one thread a library, one heap, deaf to its
    terminal.

    A terminal sends Ctrl-C, and word of its own end, to all processes; only the supervisor, who
    ends the others in order, shall hear that, also while they are still importing.
    """
    heard = signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
    try:
        with handed_down(FRUGAL):
            resource_tracker.ensure_running()  # deaf as well; its start lifts the block of SIGINT
            signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
            yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, heard)  # the run of a site is deaf itself


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
