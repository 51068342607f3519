"""What was performed in clips and runs: the rows that recognisers learn from and are tested on."""

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
"""Clips that share a pair of decoders, whose start takes as long as a clip or two; as many are
lost at most on each core when the work is stopped."""


class RecordingError(RuntimeError):
    """A clip or run of which nothing can be told; the text names the folder and the cure."""


class Due(NamedTuple):
    """A clip that is still to be tracked."""

    path: Path
    settings: Settings
    key: str


class Done(NamedTuple):
    """What a worker made of one."""

    key: str
    content: bytes
    """What `clip_cache.packed` gave; empty where the clip cannot be used."""
    refusal: str


def recordings(
    paths: Sequence[Path], mode: Mode | None, cache: Path, console: Console, posture: str = ""
) -> list[Recording]:
    """What was performed in each clip or run: the motion after the opening posture.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        mode: How clips are tracked; None: as their settings say.
        cache: Folder that keeps what tracking made of clips.
        console: For progress and warnings.
        posture: What all of them show, whatever they say.

    Raises:
        RecordingError: When a folder is neither, or names no posture: before anything is tracked.
        SettingsError, ClipError, ClipsFailed: When clips cannot be used; ClipsFailed at the end,
            which and why was said before.
    """
    folders = [Path(one.clip) for one in announced(paths, console, posture)]
    clips = [path for path in folders if not is_run(path)]
    kept = dict(zip(clips, kept_of(clips, mode, cache, console), strict=True))
    _tell_what_is_odd(kept, console)
    found = [_recording(path, kept[path] if path in kept else _of_run(path)) for path in folders]
    return [one._replace(posture=posture or one.posture) for one in found]


def announced(paths: Sequence[Path], console: Console, posture: str = "") -> list[Recording]:
    """Who performs what in each clip or run, as it says itself: nothing is tracked, there are no
    rows yet.

    Args:
        paths: As `recordings` takes them; `posture` too.
        console: For warnings.

    Raises:
        RecordingError: When a folder is neither clip nor run, or names no posture.
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
    """One line, however many the clips."""
    odd = {path: one.facts["warnings"] for path, one in kept.items() if one.facts["warnings"]}
    for path, warnings in list(odd.items())[:1]:
        others = f", and {len(odd) - 1} more clips have warnings" if len(odd) > 1 else ""
        warn(console, f"{path}: {warnings[0]}{others}")


def kept_of(
    clips: Sequence[Path], mode: Mode | None, cache: Path, console: Console
) -> list[CachedRun]:
    """What tracking makes of each clip, tracked by all cores where it is not kept yet.

    Raises:
        ClipsFailed: When clips cannot be used; which and why was said before.
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
    """Track and keep; gives how many could not be."""
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
    """What a worker does with its share."""
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
