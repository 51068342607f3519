"""A live run from its settings to its run folder."""

import json
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

from rich.console import Console

from common.bus.messages import Body, Posture
from common.bus.process import HANG_UP, ProcessContext, logged, settle, start_log
from common.config.settings import Settings
from common.heeded_signals import heeding
from common.npz_file import Facts
from common.platform.platform import Launcher
from common.platform.platforms import platform
from common.video.clip_facts import Clip
from runtime import warming
from runtime.live.admission import admitted, opened
from runtime.live.launch import Heard, nothing_heard, run
from runtime.live.page_desk import PageDesk
from runtime.live.process_table import live_parts
from runtime.live.recorded import SoFar, WholeRun
from runtime.live.run_facts import facts_of, note_lost, note_unseen
from runtime.live.run_folder import (
    KEPT,
    finish_pictures,
    new_journal,
    new_log,
    new_pictures,
    owned,
)
from runtime.live.screen import Screen
from runtime.store.past_journal import Journalled
from runtime.store.recording import Keep
from runtime.store.runs import write_postures, write_run

PLAYS: Final = "the run is over; the page plays it as long as it is open (Ctrl-C ends)"
WARMED: Final = f"{warming.__name__}.warmed"
"""The module that a run's launcher loads."""
THREAD: Final = "%(threadName)s"
"""The name in the log of a part that is a thread."""


def live(
    settings: Settings,
    out: Path,
    console: Console,
    name: str = "",
    record: bool = False,
    tell: Callable[[Heard], bool | None] = lambda _: None,
    together: bool = False,
    pictures: bool = False,
) -> Facts:
    """Run the processes on a clip or on cameras until it ends or Ctrl-C; write the run folder.

    SIGTERM ends it too, and so does SIGHUP, which a closed terminal sends.

    Args:
        settings: The run's settings.
        out: The run folder; nothing is written elsewhere.
        console: Shows the live table, each warning once, and the page's address.
        name: Name of the run; the clip's where empty.
        record: Keep the viewers' reports for a replay.
        tell: Also called ten times a second, with the messages so far; True ends the run.
        together: All parts but the page are threads of this process, with one log.
        pictures: Keep what the cameras show, a clip in the folder PICTURES of the run's.

    Returns:
        The run's summary.

    Raises:
        ClipError, ModelError, PageError, PortHeld, SettingsError, LiveRefused: When an input is
            unusable; no process was started.
        PartFailed, BusError, RunError: When something failed; the results until then are written
            first.
    """
    settings = admitted(settings, record, console)
    new = not out.exists()
    began, heard = time.monotonic(), nothing_heard()
    title = name or Path(settings.clip).name or "tritrack"
    with stopped_by_signals(console) as stop, ExitStack() as doors:
        doors.enter_context(owned(out))
        log = new_log(out)
        launcher = platform().launcher(WARMED)
        desk = PageDesk(settings, out, title, ProcessContext(True, log), launcher)
        doors.callback(desk.close)
        clip = _opened_or_nothing(settings, name, out, new=new)
        screen = Screen(clip, settings, console, lambda: desk.address)

        def facts(so_far: SoFar) -> Facts:
            return facts_of(heard, clip, time.monotonic() - began, so_far)

        desk.facts = facts
        folder = new_pictures(out, clip, pictures)
        journal = new_journal(out, clip, settings, heard.notes)
        heard = heard._replace(journal=journal)
        run_of = _Prepared(
            settings, clip, out, log, launcher, desk, screen, record, together, folder
        )
        try:
            _follow(run_of, stop, heard, tell)
        finally:
            told = _written(run_of, heard, facts)
            journal.remove()
        _show_end(desk, {**told, **_counts(out)}, stop, console)
    return told


class _Prepared(NamedTuple):
    """Everything that a run needs, before its processes start."""

    settings: Settings
    clip: Clip
    out: Path
    log: Path
    launcher: Launcher
    desk: PageDesk
    screen: Screen
    record: bool
    together: bool
    pictures: Path | None
    """Folder for what the cameras show; None: it is not kept."""


def _follow(
    run_of: _Prepared, stop: threading.Event, heard: Heard, tell: Callable[[Heard], bool | None]
) -> None:
    """Run the processes until the clip ends or `stop` is set."""
    settings, clip, out, log, launcher, desk, screen, record, together, pictures = run_of
    with ExitStack() as doors:
        kept = doors.enter_context(TemporaryDirectory(prefix=KEPT, dir=out))
        context = ProcessContext(True, log, Path(kept), pictures)
        parts = live_parts(settings, clip, context, launcher, together)
        show = doors.enter_context(screen.shown([part.name for part in (*parts, *desk.parts)]))
        doors.enter_context(logged("supervisor", log))
        if together:
            start_log(THREAD, log)
        keep = doors.enter_context(_kept(out, clip, settings, record))

        def look(heard: Heard) -> None:
            show(heard)
            if tell(heard):
                stop.set()

        heard = heard._replace(keep=keep)
        settle()
        launcher.wait(stop, lambda: look(heard))
        run(parts, settings, stop, look, heard, desk)
        note_unseen(heard)
        show(heard)


def _written(run_of: _Prepared, heard: Heard, facts: Callable[[SoFar], Facts]) -> Facts:
    """Write what was heard into the run folder; returns the summary's facts."""
    note_lost(heard)
    kept = finish_pictures(run_of.pictures, heard.notes)
    told = facts(heard.so_far) | kept
    bodies = WholeRun(heard.bodies, Journalled(run_of.out, Body))
    write_run(run_of.out, bodies, run_of.settings, told)
    postures = WholeRun(heard.postures, Journalled(run_of.out, Posture))
    write_postures(run_of.out, postures, told["posture"])
    return told


def _kept(
    out: Path, clip: Clip, settings: Settings, record: bool
) -> AbstractContextManager[Keep | None]:
    """A writer of every message of a recorded run."""
    if not record:
        return nullcontext()
    from integrator.live_rig.live_calibration import is_by_person
    from runtime.offline.batch import head_of
    from runtime.store.recording import recording_to

    return recording_to(out, head_of(clip, settings, by_person=is_by_person(clip, settings)))


def _counts(out: Path) -> dict[str, int]:
    """Number of frames written, and of those with a pose: the page may have shown fewer."""
    summary = json.loads((out / "summary.json").read_text())
    return {name: summary[name] for name in ("frames", "frames_with_pose")}


def _show_end(desk: PageDesk, facts: Facts, stop: threading.Event, console: Console) -> None:
    """Let the page play the run while a browser shows it, unless Ctrl-C ended all."""
    if desk.stopped:
        stop.clear()
    if not stop.is_set():
        desk.end(facts, stop, lambda: console.print(PLAYS))


def _opened_or_nothing(settings: Settings, name: str, out: Path, *, new: bool) -> Clip:
    """The clip of a run; where it is refused, a folder created for the run is removed."""
    try:
        return opened(settings, name)
    except BaseException:
        if new:
            shutil.rmtree(out, ignore_errors=True)
        raise


@contextmanager
def stopped_by_signals(console: Console) -> Iterator[threading.Event]:
    """An event that Ctrl-C, a closed terminal or SIGTERM sets: what goes on ends in order."""
    stop = threading.Event()

    def end(number: int) -> None:
        console.quiet |= number == HANG_UP  # writing to a closed terminal would fail
        stop.set()

    heeded = [signal.SIGINT]
    if HANG_UP and signal.getsignal(HANG_UP) is not signal.SIG_IGN:  # as under nohup
        heeded.append(HANG_UP)
    with heeding(end, *heeded), platform().asked_to_end(stop.set):
        yield stop
