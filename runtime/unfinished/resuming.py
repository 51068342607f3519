"""Whether a run begins, resumes or is over, from its folder's content and the request."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.npz_file import Facts
from common.video.clip_sources import ClipError, sources_of
from common.video.pictures import DecoderDied, Undecodable, is_recorded
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
"""The summary's key for the digest of all that a run depends on."""


class Begun(NamedTuple):
    """A run that begins or resumes."""

    work: Work
    facts: Facts
    """For its summary."""


class Wanted(NamedTuple):
    """The requested run."""

    folder: Path
    """Its folder."""
    settings: Settings
    told: Mapping[str, object]
    """Further facts from the command."""
    resume: bool = False
    """It resumes where it was interrupted."""


def done_before(wanted: Wanted, console: Console) -> Facts | None:
    """The summary of the same run, where it shall resume and is over already.

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
    """The work of a run, as far as done; it is removed when the results are written.

    When the run is stopped it stays, which is reported. When its clip cannot be used it is removed.

    Raises:
        ClipError: When a file is missing.
        CannotResume: When the existing work is of another run, damaged, or unusable.
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
        elif isinstance(error, RunError | OSError):  # no room for the state either
            warn(console, f"{kept}, but its state did not fit: --resume begins anew")
        raise
    run.remove()


def _lasts(settings: Settings) -> bool:
    """Whether a second look would give the same result."""
    of_files = all(is_recorded(view.source) for view in sources_of(settings))
    return of_files and settings.landmarks != "mediapipe"
