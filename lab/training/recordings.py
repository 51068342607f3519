"""Labelled performances in clips and runs: the rows for training and testing recognisers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from rich.console import Console

from common.config import config_file
from common.config.part_settings import RecognizerSettings
from common.config.settings import Settings
from common.method import Mode
from common.video.clip_sources import ClipError
from common.video.clips import meta_of
from common.video.pictures import DecoderDied, Undecodable
from lab.posture_models.evaluation import Recording
from recognizer.__main__ import MOVING
from recognizer.features import ROW_NAMES, rows
from recognizer.model_rate import at_model_rate
from recognizer.spotting import motion_of
from runtime.offline import clip_cache
from runtime.offline.clip_cache import CachedRun
from runtime.offline.lockstep import Decoders, track_clip
from runtime.overrides import overridden
from runtime.store.clip_paths import ClipsFailed, without_plain_files
from runtime.store.cores import made
from runtime.store.past_run import PastRunError, is_run, open_run
from runtime.store.runs import RunError
from runtime.terminal import bar, complain, warn
from runtime.unfinished.run_identity import tracker_id

BATCH: Final = 8
"""Number of clips that share a pair of decoders, whose start takes as long as one or two clips;
at most that many are lost per core when the work is stopped."""


class RecordingError(RuntimeError):
    """An unusable clip or run; the text names the folder and the cure."""


class Due(NamedTuple):
    """A clip that must still be tracked."""

    path: Path
    settings: Settings
    key: str


class Done(NamedTuple):
    """A worker's result for one."""

    key: str
    content: bytes
    """From `clip_cache.packed`; empty where the clip cannot be used."""
    refusal: str


def recordings(
    paths: Sequence[Path], mode: Mode | None, cache: Path, console: Console, posture: str = ""
) -> list[Recording]:
    """The performance in each clip or run: the motion after the opening posture.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        mode: Mode for tracking; None: that of the settings.
        cache: Folder of cached tracking results.
        console: Shows progress and warnings.
        posture: The posture of all, whatever their labels.

    Raises:
        RecordingError: When a folder is neither, or has no label: before anything is tracked.
        SettingsError, ClipError, ClipsFailed: When clips cannot be used; ClipsFailed at the end,
            after each error was reported.
    """
    folders = [Path(one.clip) for one in announced(paths, console, posture)]
    clips = [path for path in folders if not is_run(path)]
    kept = dict(zip(clips, kept_of(clips, mode, cache, console), strict=True))
    _tell_what_is_odd(kept, console)
    found = [_recording(path, kept[path] if path in kept else _of_run(path)) for path in folders]
    return [one._replace(posture=posture or one.posture) for one in found]


def announced(paths: Sequence[Path], console: Console, posture: str = "") -> list[Recording]:
    """Labels of each clip or run: nothing is tracked, there are no rows yet.

    Args:
        paths: As for `recordings`; `posture` too.
        console: Shows warnings.

    Raises:
        RecordingError: When a folder is neither clip nor run, or has no label.
        SettingsError, ClipError: When a clip cannot be found.
        ClipsFailed: When there is none.
    """
    told = [_announced(path) for path in without_plain_files(paths, console)]
    nameless = [one.clip for one in told if not (posture or one.posture)]
    if nameless:
        others = f", and {len(nameless) - 1} more name none" if len(nameless) > 1 else ""
        raise RecordingError(
            f"{nameless[0]} names no posture: write it into the clip's meta.json{others}"
        )
    return told


def _announced(path: Path) -> Recording:
    nothing = np.empty((0, len(ROW_NAMES)))
    if is_run(path):
        facts = _of_run(path).facts
        return Recording(
            facts.get("performer", ""), facts.get("posture_meant", ""), nothing, str(path)
        )
    meta = meta_of(config_file.load(path))
    return Recording(meta.performer, meta.posture, nothing, str(path))


def _tell_what_is_odd(kept: dict[Path, CachedRun], console: Console) -> None:
    """One line, for any number of clips."""
    odd = {path: one.facts["warnings"] for path, one in kept.items() if one.facts["warnings"]}
    for path, warnings in list(odd.items())[:1]:
        others = f", and {len(odd) - 1} more clips have warnings" if len(odd) > 1 else ""
        warn(console, f"{path}: {warnings[0]}{others}")


def kept_of(
    clips: Sequence[Path], mode: Mode | None, cache: Path, console: Console
) -> list[CachedRun]:
    """The tracking result of each clip, computed on all cores where it is not cached.

    Raises:
        ClipsFailed: When clips cannot be used; each error was reported before.
        RunError: When the cache cannot be written.
    """
    tracker = tracker_id()
    keys, due = {}, []
    for path in clips:
        settings = overridden(config_file.load(path), mode, None)
        keys[path] = clip_cache.key_of(settings, tracker)
        if clip_cache.read(cache, keys[path]) is None:
            due.append(Due(path, settings, keys[path]))
    refused = _track_all(due, cache, console)
    if refused:
        raise ClipsFailed(f"{refused} of {len(clips)} clips could not be tracked")
    found = [clip_cache.read(cache, key) for key in keys.values()]
    return [kept for kept in found if kept is not None]


def _track_all(due: Sequence[Due], cache: Path, console: Console) -> int:
    """Track and cache; returns the number of failures."""
    batches = [due[at : at + BATCH] for at in range(0, len(due), BATCH)]
    refused = 0
    with bar(console) as progress:
        task = progress.add_task("tracking", total=len(due))
        for batch in made(_track, batches) if due else ():
            for done in batch:
                progress.advance(task)
                refused += bool(done.refusal)
                if done.refusal:
                    complain(console, done.refusal)
                else:
                    _keep(cache, done)
    return refused


def _keep(cache: Path, done: Done) -> None:
    try:
        clip_cache.write(cache, done.key, done.content)
    except OSError as error:
        raise RunError(
            f"cannot write {cache}: {error.strerror}; free some space or name another --cache"
        ) from error


def _track(batch: Sequence[Due]) -> list[Done]:
    """A worker's job on its share."""
    cv2.setNumThreads(1)
    with Decoders() as decoders:
        return [_tracked(due, decoders) for due in batch]


def _tracked(due: Due, decoders: Decoders) -> Done:
    content, refusal = b"", ""
    try:
        content = clip_cache.packed(track_clip(due.settings, decoders))
    except (ClipError, DecoderDied, Undecodable) as error:
        refusal = str(error)
    return Done(due.key, content, refusal)


def _of_run(path: Path) -> CachedRun:
    try:
        run = open_run(path)
        return CachedRun(run.summary, {name: run.poses[name] for name in clip_cache.KEPT})
    except PastRunError as error:
        raise RecordingError(str(error)) from error


def _recording(path: Path, kept: CachedRun) -> Recording:
    arrays = kept.arrays
    tracked = rows(arrays["angles_deg"], arrays["joints_m"])
    moving = np.where(np.isin(arrays["status"], MOVING)[:, None], tracked, np.nan)
    window = RecognizerSettings().window_frames
    motion = motion_of(at_model_rate(arrays["time_s"], moving), window)
    facts = kept.facts
    return Recording(facts.get("performer", ""), facts["posture_meant"], motion, str(path))
