"""Whether a run begins, goes on or is over: what its folder holds of it, and what is wanted."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.npz_file import Facts
from common.video.clip_sources import ClipError, footage_of
from common.video.pictures import DecoderDied, Undecodable
from runtime.store import journal
from runtime.store.runs import RunError
from runtime.terminal import say, warn
from runtime.unfinished.run_identity import identity_of, word_of
from runtime.unfinished.unfinished_run import (
    FOLDER,
    STATE,
    CannotResume,
    UnfinishedRun,
    saved_in,
)
from runtime.unfinished.work import InMemory, Work

MADE_OF: Final = "made_of"
"""What the summary of a run calls the word for all that it depends on."""


class Begun(NamedTuple):
    """A run that begins, or goes on."""

    work: Work
    facts: Facts
    """For its summary."""


class Wanted(NamedTuple):
    """What is to be run."""

    folder: Path
    """Of the run."""
    settings: Settings
    told: Mapping[str, object]
    """What else the command says of it."""
    resume: bool = False
    """It goes on where it was left."""


def done_before(wanted: Wanted, console: Console) -> Facts | None:
    """The summary of the same run, where it is to be resumed and is over already.

    Raises:
        ClipError: When a file is missing.
    """
    path = wanted.folder / "summary.json"
    if not wanted.resume or not _lasts(wanted.settings) or (wanted.folder / FOLDER).exists():
        return None
    try:
        summary: Facts = json.loads(path.read_text())
    except (OSError, ValueError):
        return None
    word = word_of(identity_of(wanted.settings, wanted.told))
    if summary.get(MADE_OF) != word:
        return None
    say(console, f"{wanted.folder.name}: is done already, of {summary['frames']} frames")
    return summary


@contextmanager
def resumable(wanted: Wanted, console: Console) -> Iterator[Begun]:
    """The work of a run, as far as it had come; what it keeps goes when its results are written.

    Where the run is stopped it stays, and that is said. Where its clip cannot be used it goes.

    Raises:
        ClipError: When a file is missing.
        CannotResume: When what is there is of another run, or damaged, or cannot be gone on with.
        RunError: When the folder cannot be written.
    """
    if not _lasts(wanted.settings):
        if wanted.resume:
            raise CannotResume(
                f"{wanted.folder.name}: what a camera or MediaPipe sees cannot be gone on with: "
                "leave out --resume"
            )
        yield Begun(InMemory(), {})
        return
    identity = identity_of(wanted.settings, wanted.told)
    head = journal.Head(settings=wanted.settings, facts={"clip": wanted.folder.name})
    saved = saved_in(wanted.folder, identity) if wanted.resume else None
    if saved is not None:
        frames = max((place.messages for place in saved.places.values()), default=0)
        say(console, f"{wanted.folder.name}: goes on after {frames} frames ({saved.stage})")
    run = UnfinishedRun(wanted.folder, identity, head, saved)
    try:
        yield Begun(run, {MADE_OF: word_of(identity)})
    except (ClipError, SettingsError, Undecodable, DecoderDied):
        run.remove()
        raise
    except CannotResume:
        run.close()
        raise
    except BaseException as error:
        run.close()
        kept = f"{wanted.folder.name}: what is done is kept"
        if (wanted.folder / FOLDER / STATE).is_file():
            warn(console, f"{kept}: --resume goes on with it")
        elif isinstance(error, RunError | OSError):  # the disk takes no more, its state neither
            warn(console, f"{kept}, but its state did not fit: --resume begins anew")
        raise
    run.remove()


def _lasts(settings: Settings) -> bool:
    """Whether the same is seen when it is looked at again."""
    of_files = all(isinstance(view.source, str) for view in footage_of(settings))
    return of_files and settings.landmarks != "mediapipe"
