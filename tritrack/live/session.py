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
from types import FrameType
from typing import Any, Final, NamedTuple

import msgspec
from rich.console import Console

from common.bus.messages import Body, Posture
from common.bus.process import ProcessContext, logged, start_log
from common.config.settings import Settings
from common.method import METHODS
from common.settled import settle
from common.video.clip_facts import Clip, both_cameras
from tritrack.forking.zygote import Zygote
from tritrack.live.free_ports import own_session, refuse_held_ports, with_free_endpoint
from tritrack.live.launch import Heard, nothing_heard, run
from tritrack.live.page_desk import SAVED, PageDesk
from tritrack.live.process_table import inherited, live_parts
from tritrack.live.recorded import SoFar, WholeRun
from tritrack.live.run_facts import facts_of, facts_of_clip, note_lost, note_unseen
from tritrack.live.screen import Screen
from tritrack.store.journal import Head as JournalHead
from tritrack.store.journal import Journal, has_journal
from tritrack.store.past_journal import LOG, Journalled, put_aside
from tritrack.store.recording import Keep, refuse_without_library, torn_recordings
from tritrack.store.runs import write_postures, write_run

PLAYS: Final = "the run is over; the page plays it as long as it is open (Ctrl-C ends)"
KEPT: Final = ".kept-"
"""Begins the name of the folder in which processes leave what their next start takes up."""
THREAD: Final = "%(threadName)s"
"""What the log calls a part that is a thread."""
NO_POSTURE: Final = -1
"""posture_id of a clip that shows none of the postures: free motion, a test of the tracker."""


class LiveRefused(ValueError):
    """A live run that cannot begin; the text says why and what to do."""


def live(
    settings: Settings,
    out: Path,
    console: Console,
    name: str = "",
    record: bool = False,
    tell: Callable[[Heard], bool | None] = lambda _: None,
    together: bool = False,
) -> dict[str, Any]:
    """Run the processes on a clip or on cameras until it ends or Ctrl-C; write the run folder.

    SIGTERM ends it too, and SIGHUP, which a terminal says that is closed.

    Args:
        settings: Of the run.
        out: The run folder; nothing is written elsewhere.
        console: Shows the live table, each warning once, and the page's address.
        name: Of the run; the clip's when empty.
        record: Keep what the viewers report, so that it can be replayed.
        tell: Called ten times a second too, with what was heard so far; True ends the run.
        together: All parts but the page are threads of this process, which logs as one.

    Returns:
        What the run's summary tells.

    Raises:
        ClipError, ModelError, PageError, PortHeld, SettingsError, LiveRefused: When something
            cannot be worked with; no process was started.
        PartFailed, BusError, RunError: When something failed; what was tracked until then is
            written first.
    """
    settings = _admitted(settings, record, console)
    new = not out.exists()
    began, heard = time.monotonic(), nothing_heard()
    title = name or Path(settings.clip).name or "tritrack"
    with _stopped_by_signals(console) as stop, ExitStack() as doors:
        log = _new_log(out)
        zygote = Zygote(inherited)
        desk = PageDesk(settings, out, title, ProcessContext(True, log), zygote)
        doors.callback(desk.close)
        clip = _opened_or_nothing(settings, name, out, new=new)
        screen = Screen(clip, settings, console, lambda: desk.address)

        def facts(so_far: SoFar) -> dict[str, Any]:
            return facts_of(heard, clip, time.monotonic() - began, so_far)

        desk.facts = facts
        journal = _journal(out, clip, settings, heard.notes)
        heard = heard._replace(journal=journal)
        try:
            _follow(
                _Prepared(settings, clip, out, log, zygote, desk, screen, record, together),
                stop,
                heard,
                tell,
            )
        finally:
            note_lost(heard)
            told = facts(heard.so_far)
            bodies = WholeRun(heard.bodies, Journalled(out, Body))
            write_run(out, bodies, settings, told)
            postures = WholeRun(heard.postures, Journalled(out, Posture))
            write_postures(out, postures, told["posture"])
            journal.remove()
        _show_end(desk, {**told, **_counts(out)}, stop, console)
    return told


class _Prepared(NamedTuple):
    """All that a run is of, before its processes start."""

    settings: Settings
    clip: Clip
    out: Path
    log: Path
    zygote: Zygote
    desk: PageDesk
    screen: Screen
    record: bool
    together: bool


def _follow(
    run_of: _Prepared, stop: threading.Event, heard: Heard, tell: Callable[[Heard], bool | None]
) -> None:
    """Run the processes until the clip ends or `stop` is set."""
    settings, clip, out, log, zygote, desk, screen, record, together = run_of
    with ExitStack() as doors:
        kept = doors.enter_context(TemporaryDirectory(prefix=KEPT, dir=out))
        context = ProcessContext(True, log, Path(kept))
        parts = live_parts(settings, clip, context, zygote, together)
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
        zygote.wait(stop, lambda: look(heard))
        run(parts, settings, stop, look, heard, desk)
        note_unseen(heard)
        show(heard)


def _admitted(settings: Settings, record: bool, console: Console) -> Settings:
    """Settings that can be worked with, with the endpoint and the session that they leave open."""
    refuse_mode(settings)
    if record:
        refuse_without_library()
    found = with_free_endpoint(settings)
    refuse_held_ports(found)
    if found != settings:
        console.print(f"the bus: {found.bus.endpoint}", highlight=False)
    return own_session(found)


def _journal(out: Path, clip: Clip, settings: Settings, notes: list[str]) -> Journal:
    """What takes each body as it comes; the journal of a run that was cut short is put aside."""
    aside = out / SAVED / f"cut_short_{time.strftime('%Y%m%d_%H%M%S')}"
    try:
        if put_aside(out, aside):
            for torn in torn_recordings(out):
                torn.replace(aside / torn.name)
            notes.append(f"the run before this one was cut short: what it measured is in {aside}")
    except OSError as error:
        raise LiveRefused(
            f"{out} holds a run that was cut short, which cannot be put aside "
            f"({error.strerror}): name another --out"
        ) from error
    return Journal(out, JournalHead(settings=settings, facts=facts_of_clip(clip)))


def _kept(
    out: Path, clip: Clip, settings: Settings, record: bool
) -> AbstractContextManager[Keep | None]:
    """What takes each message of a run that is recorded."""
    if not record:
        return nullcontext()
    from integrator.live_rig.live_calibration import is_by_person
    from tritrack.offline.batch import head_of
    from tritrack.store.recording import recording_to

    return recording_to(out, head_of(clip, settings, by_person=is_by_person(clip, settings)))


def _counts(out: Path) -> dict[str, int]:
    """How many frames were written, and how many with a pose: the page may have shown fewer."""
    summary = json.loads((out / "summary.json").read_text())
    return {name: summary[name] for name in ("frames", "frames_with_pose")}


def _show_end(
    desk: PageDesk, facts: dict[str, Any], stop: threading.Event, console: Console
) -> None:
    """Let the page play the run for who looks at it, unless Ctrl-C ended all."""
    if desk.stopped:
        stop.clear()
    if not stop.is_set():
        desk.end(facts, stop, lambda: console.print(PLAYS))


def _opened_or_nothing(settings: Settings, name: str, out: Path, *, new: bool) -> Clip:
    """The clip of a run; where it is refused, a folder that was made for the run goes again."""
    try:
        return _opened(settings, name)
    except BaseException:
        if new:
            shutil.rmtree(out, ignore_errors=True)
        raise


def _opened(settings: Settings, name: str) -> Clip:
    """The clip of a run that will not fail for what can be known before.

    Its imports take a second, in which the page is opened.
    """
    from common.video.clips import open_clip
    from tritrack.offline.lockstep import measured_before

    clip = open_clip(settings)
    clip = msgspec.structs.replace(
        clip,
        name=name or clip.name,
        rig=both_cameras(clip),
        body=measured_before(settings),
    )
    _refuse_what_would_fail(settings, clip)
    return clip


def refuse_mode(settings: Settings) -> None:
    """Say that the thesis's mode has no processes.

    Raises:
        LiveRefused: When it is asked for.
    """
    if METHODS[settings.mode].stick_lifting:
        raise LiveRefused(
            "the thesis's mode is not for live runs: set mode = 'default' or 'paper', or follow "
            "a recorded video with: tritrack single VIDEO --mode thesis"
        )


def _refuse_what_would_fail(settings: Settings, clip: Clip) -> None:
    """Say before any process starts what one of them would fail on."""
    from recognizer.__main__ import model_of
    from viewer.landmarks.landmark_sources import refuse_landmarks

    meant = "" if clip.meta.posture_id == NO_POSTURE else clip.meta.posture
    model_of(settings, meant)
    refuse_landmarks(settings, clip.views)


def _new_log(out: Path) -> Path:
    """The log of this run alone: of a run before it in the same folder it is overwritten, unless
    that was cut short, and is to be put aside."""
    path = out / LOG
    try:
        out.mkdir(parents=True, exist_ok=True)
        path.open("a" if has_journal(out) else "w").close()
        for left in out.glob(f"{KEPT}*"):  # by a run that was cut short
            shutil.rmtree(left, ignore_errors=True)
    except OSError as error:
        raise LiveRefused(f"cannot write {out}: {error.strerror}; name another --out") from error
    return path


@contextmanager
def _stopped_by_signals(console: Console) -> Iterator[threading.Event]:
    stop = threading.Event()

    def end(number: int, _frame: FrameType | None) -> None:
        console.quiet |= number == signal.SIGHUP  # each word to a closed terminal would fail
        stop.set()

    heeded = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # as under nohup
        heeded.append(signal.SIGHUP)
    before = {number: signal.signal(number, end) for number in heeded}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
