"""The processes of a live run: their table, how each starts, and how it ends."""

from collections.abc import Callable
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any, Final, NamedTuple

from animator.page.door import Entrance
from common.bus.process import ProcessContext
from common.config.settings import Settings
from common.platform.platform import Job, Launcher, Worker
from common.platform.platforms import platform
from common.video.clip_facts import Clip
from runtime.live.thread_worker import ThreadWorker, confessed

END_S: Final = 5.0
"""Default time to close, seconds."""


class Part(NamedTuple):
    """One process of a run."""

    name: str
    main: Callable[..., None]
    arguments: tuple[Any, ...]
    leads: bool = False
    """The run is over when all leading processes have ended."""
    spare: bool = False
    """The run goes on without it once it is given up."""
    beats: bool = False
    """It sends a pulse every second, whatever the others do; without one it hangs."""
    nests: bool = False
    """It starts processes of its own."""
    end_s: float = END_S
    """Time to close before it is killed, seconds."""
    launcher: Launcher | None = None
    """How it starts fastest."""
    beside: bool = False
    """It is a thread of the supervisor's process."""


class Running(NamedTuple):
    """A started part."""

    part: Part
    process: Worker
    words: Connection
    """Connection on which it reports its error."""


def live_parts(
    settings: Settings,
    clip: Clip,
    context: ProcessContext,
    launcher: Launcher,
    beside: bool = False,
) -> list[Part]:
    """The table of a live run: receivers come before senders (P2).

    Args:
        settings: The run's settings.
        clip: The run's clip.
        context: Context for the parts.
        launcher: How they start fastest.
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
    return [part._replace(launcher=launcher, beside=beside) for part in parts]


def names_of(clip: Clip) -> tuple[str, ...]:
    """The processes that a run requires."""
    return ("integrator", "recognizer", *(f"viewer {view.number}" for view in clip.views))


def page_part(
    settings: Settings,
    context: ProcessContext,
    title: str,
    ending: Connection,
    entrance: Entrance,
    launcher: Launcher | None = None,
) -> Part:
    """The process of the live page: started first, ended last."""
    arguments = (settings, context, title, ending, entrance)
    return Part("animator", animator_main, arguments, launcher=launcher)


def integrator_main(*arguments: Any) -> None:
    """The integrator, imported in its own process."""
    from integrator.__main__ import main

    main(*arguments)


def recognizer_main(*arguments: Any) -> None:
    """The recognizer, imported in its own process."""
    from recognizer.__main__ import main

    main(*arguments)


def animator_main(*arguments: Any) -> None:
    """The animator, imported in its own process."""
    from animator.__main__ import main

    main(*arguments)


def metrics_main(*arguments: Any) -> None:
    """The metrics, imported in their own process."""
    from runtime.outside.metrics_process import main

    main(*arguments)


def viewer_main(*arguments: Any) -> None:
    """A viewer, imported in its own process."""
    from viewer.__main__ import main

    main(*arguments)


def started(part: Part) -> Running:
    """Start a part: as a thread, by its launcher, else as a new Python."""
    if part.beside:
        ours, theirs = Pipe(duplex=False)
        return Running(part, ThreadWorker(part.name, part.main, part.arguments, theirs), ours)
    begin = platform().start if part.launcher is None else part.launcher.start
    arguments = (part.name, part.main, part.arguments)
    return Running(part, *begin(Job(part.name, _guarded, arguments, part.nests)))


def end(one: Running) -> bool:
    """Ask it to end, wait, then kill; whether it ended without the kill."""
    if one.process.is_alive():
        one.process.terminate()
        one.process.join(one.part.end_s)
    if not one.process.is_alive():
        return True
    one.process.kill()
    one.process.join()
    return False


def last_words(one: Running) -> str:
    """Why a process ended; one that was killed reports nothing."""
    try:
        if one.words.poll():
            return str(one.words.recv())
    except EOFError:
        pass
    code = one.process.exitcode or 0
    return f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"


def _guarded(
    name: str, main: Callable[..., None], arguments: tuple[Any, ...], words: Connection
) -> None:
    """Run a part; an error becomes one line, not a traceback."""
    try:
        main(*arguments)
    except Exception as error:
        raise SystemExit(confessed(name, error, words)) from None
