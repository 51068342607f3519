"""The folder of a new live run: its log, its journal, and the remains of an interrupted run."""

import shutil
import time
from pathlib import Path
from typing import Final

from common.config.settings import Settings
from common.video.clip_facts import Clip
from runtime.live.admission import LiveRefused
from runtime.live.page_desk import SAVED
from runtime.live.run_facts import facts_of_clip
from runtime.store.journal import Head as JournalHead
from runtime.store.journal import Journal, has_journal
from runtime.store.past_journal import LOG, put_aside
from runtime.store.recording import torn_recordings

KEPT: Final = ".kept-"
"""Prefix of the folder in which processes leave their state for a restart."""


def new_log(out: Path) -> Path:
    """The log of this run alone: an earlier run's log is overwritten, unless that run was
    interrupted and will be moved aside.

    Raises:
        LiveRefused: When the folder cannot be written.
    """
    path = out / LOG
    try:
        out.mkdir(parents=True, exist_ok=True)
        path.open("a" if has_journal(out) else "w").close()
        for left in out.glob(f"{KEPT}*"):  # of an interrupted run
            shutil.rmtree(left, ignore_errors=True)
    except OSError as error:
        raise LiveRefused(f"cannot write {out}: {error.strerror}; name another --out") from error
    return path


def new_journal(out: Path, clip: Clip, settings: Settings, notes: list[str]) -> Journal:
    """A writer of bodies as they come; the journal of an interrupted run is moved aside.

    Args:
        out: The run's folder.
        clip: The run's clip.
        settings: The run's settings.
        notes: Receives a note about what was moved.

    Raises:
        LiveRefused: When it cannot be moved aside.
    """
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
