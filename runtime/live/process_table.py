"""The processes of a live run: the table of them, how one is started, and how it is ended."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from typing import Any, Final, NamedTuple

from animator.page.door import Entrance
from common.bus.process import ProcessContext
from common.child.parent_death import end_with_parent
from common.child.process_name import be_shown_as
from common.config.settings import Settings
from common.video.clip_facts import Clip
from runtime.forking.reparenting import ReparentedProcess, adopted, adopting, be_adopted
from runtime.forking.zygote import FORK, SPAWN, Zygote
from runtime.live.thread_worker import ThreadWorker, confessed

END_S: Final = 5.0
"""What most processes may take to close their doors."""
OF_TERMINALS: Final = (signal.SIGINT, signal.SIGHUP)
FRUGAL: Final = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
}
"""One thread a library, and one heap for all threads: glibc would make one for each of Zenoh's."""


class Part(NamedTuple):
    """One process of a run."""

    name: str
    main: Callable[..., None]
    arguments: tuple[Any, ...]
    leads: bool = False
    """The run is over when all that lead have ended."""
    spare: bool = False
    """The run goes on where it was given up."""
    beats: bool = False
    """While it runs it says so once a second, whatever the others do: if it does not, it hangs."""
    nests: bool = False
    """It starts processes of its own."""
    end_s: float = END_S
    """How long it may take to close its doors before it is killed."""
    zygote: Zygote | None = None
    """Of which it is forked, where that is warm."""
    beside: bool = False
    """It is a thread of the supervisor's process."""


class Running(NamedTuple):
    """A part that was started."""

    part: Part
    process: BaseProcess | ReparentedProcess | ThreadWorker
    words: Connection
    """On which it says why it fails."""


def live_parts(
    settings: Settings, clip: Clip, context: ProcessContext, zygote: Zygote, beside: bool = False
) -> list[Part]:
    """The table of a live run: who listens comes before who speaks (P2).

    Args:
        settings: Of the run.
        clip: What is looked at.
        context: How its parts run.
        zygote: Of which they are forked.
        beside: They are threads of this process instead.
    """
    period_s = clip.every / clip.views[0].fps
    parts = [
        Part("integrator", integrator_main, (settings, clip, context), beats=True, nests=True),
        Part("recognizer", recognizer_main, (settings, period_s, context)),
    ]
    if settings.metrics:
        arguments = (settings, names_of(clip), context)
        parts.append(Part("metrics", metrics_main, arguments, spare=True))
    for view in clip.views:
        seen_by = (settings, view.number, context)
        name = f"viewer {view.number}"
        parts.append(Part(name, viewer_main, seen_by, leads=True, beats=True, nests=True))
    return [part._replace(zygote=zygote, beside=beside) for part in parts]


def names_of(clip: Clip) -> tuple[str, ...]:
    """The processes that a run cannot do without."""
    return ("integrator", "recognizer", *(f"viewer {view.number}" for view in clip.views))


def page_part(
    settings: Settings,
    context: ProcessContext,
    title: str,
    ending: Connection,
    entrance: Entrance,
    zygote: Zygote | None = None,
) -> Part:
    """The process of the live page: started first, and the last to end."""
    arguments = (settings, context, title, ending, entrance)
    return Part("animator", animator_main, arguments, zygote=zygote)


def integrator_main(*arguments: Any) -> None:
    """The integrator, imported where it runs."""
    from integrator.__main__ import main

    main(*arguments)


def recognizer_main(*arguments: Any) -> None:
    """The recognizer, imported where it runs."""
    from recognizer.__main__ import main

    main(*arguments)


def animator_main(*arguments: Any) -> None:
    """The animator, imported where it runs."""
    from animator.__main__ import main

    main(*arguments)


def metrics_main(*arguments: Any) -> None:
    """The metrics, imported where they are served."""
    from runtime.outside.metrics_process import main

    main(*arguments)


def viewer_main(*arguments: Any) -> None:
    """A viewer, imported where it runs."""
    from viewer.__main__ import main

    main(*arguments)


def started(part: Part) -> Running:
    """A part, begun: beside its supervisor, forked where there is a warm zygote, else a new
    Python."""
    if part.beside:
        ours, theirs = SPAWN.Pipe(duplex=False)
        return Running(part, ThreadWorker(part.name, part.main, part.arguments, theirs), ours)
    if part.zygote is not None and part.zygote.context is FORK:
        with suppress(EOFError, OSError):  # the zygote dies at this moment
            return _begun(part, FORK)
    return _begun(part, SPAWN)


def _begun(part: Part, context: ForkServerContext | SpawnContext) -> Running:
    forked = context is FORK
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(
        name=part.name,
        target=_guarded,
        args=(part.name, part.main, part.arguments, theirs, forked),
        daemon=not part.nests,
    )
    with inherited(), adopting() if forked else nullcontext():
        process.start()
        theirs.close()
        return Running(part, adopted(process, ours) if forked else process, ours)


def end(one: Running) -> bool:
    """Ask, wait, then kill; whether it ended without that."""
    if one.process.is_alive():
        one.process.terminate()
        one.process.join(one.part.end_s)
    if not one.process.is_alive():
        return True
    one.process.kill()
    one.process.join()
    return False


def last_words(one: Running) -> str:
    """Why a process ended; one that was killed says nothing."""
    try:
        if one.words.poll():
            return str(one.words.recv())
    except EOFError:
        pass
    code = one.process.exitcode or 0
    return f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"


@contextmanager
def inherited() -> Iterator[None]:
    """What a process takes over from its supervisor: one thread a library, one heap, deaf to its
    terminal.

    A terminal sends Ctrl-C, and word of its own end, to all processes; only the supervisor, who
    ends the others in order, shall hear that, also while they are still importing.
    """
    before = dict(os.environ)
    os.environ.update(FRUGAL)
    heard = signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
    try:
        resource_tracker.ensure_running()  # deaf as well; its start lifts the block of SIGINT
        signal.pthread_sigmask(signal.SIG_BLOCK, OF_TERMINALS)
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, heard)  # the run of a site is deaf itself
        os.environ.clear()
        os.environ.update(before)


def _guarded(
    name: str,
    main: Callable[..., None],
    arguments: tuple[Any, ...],
    words: Connection,
    forked: bool,
) -> None:
    """Run a part; what it cannot do is said in one line, not in a traceback."""
    if forked:
        be_adopted(words)
    be_shown_as(name)
    end_with_parent()
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGTERM,))  # the zygote is deaf to it
    try:
        main(*arguments)
    except Exception as error:
        raise SystemExit(confessed(name, error, words)) from None
