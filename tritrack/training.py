"""Posture models from clips or runs."""

import json
import zipfile
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from common import config
from common.config import Mode, RecognizerSettings
from recognizer.__main__ import MOVING
from recognizer.evaluation import Recording
from recognizer.features import rows
from recognizer.learning import train
from recognizer.model_file import save
from recognizer.postures import Recognizer
from recognizer.spotting import motion_of
from tritrack.offline import Decoders, overridden, track_clip, without_plain_files
from tritrack.runs import poses
from tritrack.terminal import bar, warn


class TrainingError(ValueError):
    """Clips or runs that nothing can be learnt from; the text names the folder and the cure."""


def train_postures(
    paths: Sequence[Path],
    out: Path,
    mode: Mode | None,
    console: Console,
    recognizer: Recognizer = "default",
) -> dict[str, Any]:
    """Learn a model of each posture and write it.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        out: The file to write.
        mode: How clips are tracked; None: as their settings say.
        console: For progress and warnings.
        recognizer: Which kind of model.

    Raises:
        TrainingError: When a folder is neither, or names no posture, or the file cannot be written.
        ClipError: When a clip cannot be used.
    """
    learnt: dict[str, list[Any]] = defaultdict(list)
    performers = set()
    for recording in recordings(paths, mode, console):
        learnt[recording.posture].append(recording.rows)
        performers.add(recording.performer)
    try:
        model = train(dict(learnt), recognizer, performers=sorted(performers))
        out.parent.mkdir(parents=True, exist_ok=True)
        save(model, out)
    except (ValueError, OSError) as error:
        raise TrainingError(f"cannot learn or write {out}: {error}") from error
    return {
        "model": str(out),
        "sequences": {name: len(given) for name, given in sorted(learnt.items())},
        "performers": sorted(performers),
    }


def recordings(paths: Sequence[Path], mode: Mode | None, console: Console) -> list[Recording]:
    """What was performed in each clip or run: the motion after the opening posture."""
    folders = without_plain_files(paths, console)
    with Decoders() as decoders, bar(console) as progress:
        return [
            _of_run(path)
            if (path / "poses.npz").is_file()
            else _of_clip(path, mode, decoders, console)
            for path in progress.track(folders, description="reading")
        ]


def _of_clip(path: Path, mode: Mode | None, decoders: Decoders, console: Console) -> Recording:
    tracked = track_clip(overridden(config.load(path), mode, None), decoders)
    for warning in tracked.facts["warnings"]:
        warn(console, warning)
    return _recording(path, tracked.facts, poses(tracked.bodies))


def _of_run(path: Path) -> Recording:
    try:
        facts = json.loads((path / "summary.json").read_text())
        with np.load(path / "poses.npz", allow_pickle=False) as arrays:
            return _recording(path, facts, {name: arrays[name] for name in arrays.files})
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise TrainingError(f"{path} is no run folder: {error}; track the clip again") from error


def _recording(path: Path, facts: dict[str, Any], arrays: dict[str, Any]) -> Recording:
    posture = facts.get("posture_meant", "")
    if not posture:
        raise TrainingError(f"{path} names no posture: write it into the clip's meta.json")
    tracked = rows(arrays["angles_deg"], arrays["joints_m"])
    moving = np.where(np.isin(arrays["status"], MOVING)[:, None], tracked, np.nan)
    window = RecognizerSettings().window_frames
    return Recording(facts.get("performer", ""), posture, motion_of(moving, window))
