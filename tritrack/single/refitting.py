"""A run of one camera fitted again with the user's inputs, in a separate process (T22, T26)."""

import multiprocessing
import os
import signal
import tempfile
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Final, Literal, NamedTuple

from rich.console import Console

from animator.retouching.fitting import FitError
from animator.video_file import VideoError
from common.config.settings import Settings
from common.notes.notes import Notes
from runtime.store.past_run import PastRunError
from runtime.store.run_exports import EXPORTS, OWN_NAMES, Format
from runtime.store.runs import RunError
from runtime.terminal import Tell
from runtime.unfinished.resuming import Begun
from runtime.unfinished.work import InMemory
from tritrack.exporting import ExportError, export_run
from tritrack.single.animation_files import NAMES
from tritrack.single.single import PASSES, UNUSABLE, Job, follow

HEARD_S: Final = 0.2
END_S: Final = 5.0
"""Time for a process to end when asked, seconds; then it is killed."""
STEP: Final = 0.05
"""Share of a pass between two progress reports."""
SPAWN: Final = multiprocessing.get_context("spawn")


class Said(NamedTuple):
    """Messages of the fitting process."""

    kind: Literal["far", "done", "failed"]
    text: str = ""


def refit(
    folder: Path,
    settings: Settings,
    notes: Notes,
    tell: Callable[[str], object],
    stop: threading.Event,
) -> None:
    """Fit a run's video with these notes; its files are replaced when all new ones are written.

    Exports of the previous fit are made anew; files that the new one does not have are removed.

    Args:
        folder: Folder of a run that `tritrack single` wrote.
        settings: The run's settings; camera 1 is its video.
        notes: All inputs for the video.
        tell: Receives the progress.
        stop: Set to stop.

    Raises:
        FitError: When the video cannot be fitted, or it was stopped: the run is unchanged.
    """
    try:
        with tempfile.TemporaryDirectory(prefix=".again-", dir=folder) as scratch:
            new = Path(scratch) / folder.name
            _fitted_apart(new, settings, notes, tell, stop)
            made = [file.name for file in sorted(new.iterdir())]
            had = [to for to, name in OWN_NAMES.items() if (folder / name).is_file()]
            for name in made:
                os.replace(new / name, folder / name)
            for name in {*EXPORTS, *NAMES}.difference(made):
                (folder / name).unlink(missing_ok=True)
            _renew(folder, [to for to in had if OWN_NAMES[to] not in made], tell)
    except OSError as error:
        raise FitError(
            f"cannot write {error.filename or folder}: {error.strerror}; see that you may write "
            "there and that its disk has room, then fit again"
        ) from error


def _renew(folder: Path, formats: list[Format], tell: Callable[[str], object]) -> None:
    for to in formats:
        try:
            export_run(folder, to, None)
        except (ExportError, PastRunError) as error:
            tell(f"{OWN_NAMES[to]} was not made anew: {error}")


def _fitted_apart(
    new: Path,
    settings: Settings,
    notes: Notes,
    tell: Callable[[str], object],
    stop: threading.Event,
) -> None:
    ours, theirs = SPAWN.Pipe(duplex=False)
    child = SPAWN.Process(target=_fit, args=(new, settings, notes, theirs))
    child.start()
    theirs.close()
    try:
        last = Said("far")
        while last.kind == "far":
            last = _next(ours, stop)
            tell(last.text)
    finally:
        _end(child)
        ours.close()
    if last.kind == "failed":
        raise FitError(last.text)


def _next(ours: Connection, stop: threading.Event) -> Said:
    while not ours.poll(HEARD_S):
        if stop.is_set():
            return Said("failed", "the page was closed: the run is as it was")
    try:
        said: Said = ours.recv()
    except EOFError:
        return Said("failed", "what fitted the video was killed, the run is as it was: fit again")
    return said


def _end(child: BaseProcess) -> None:
    child.terminate()
    child.join(END_S)
    if child.exitcode is None:
        child.kill()
        child.join()


def _fit(folder: Path, settings: Settings, notes: Notes, said: Connection) -> None:
    """The process: its starter ends it, whatever a terminal's Ctrl-C does."""
    from common.video.decoding import Decoder

    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def begun(name: str) -> Tell:
        told = -1.0

        def tell(share: float) -> None:
            nonlocal told
            if share - told >= STEP:
                told = share
                step = f"step {PASSES.index(name) + 1} of {len(PASSES)}"
                said.send(Said("far", f"fitting again, {step}: {name}, {share:.0%}"))

        return tell

    sources = [camera.source for camera in settings.cameras.values()]
    job = Job(Path(sources[0] if sources else ""), settings, None, notes)
    try:
        with Decoder() as decoder:
            follow(job, folder, decoder, Console(quiet=True), begun, Begun(InMemory(), {}))
        said.send(Said("done", "fitted"))
    except (*UNUSABLE, RunError, VideoError) as error:
        said.send(Said("failed", f"{error}; the run is as it was"))
