"""Posture models from clips or runs."""

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from common.config import Mode
from recognizer.learning import train
from recognizer.model_file import save
from recognizer.postures import Recognizer
from tritrack.cores import spread
from tritrack.performances import recordings


class TrainingError(ValueError):
    """Nothing can be learnt, or the model cannot be written; the text names the cure."""


def train_postures(
    paths: Sequence[Path],
    out: Path,
    mode: Mode | None,
    console: Console,
    recognizer: Recognizer,
    cache: Path,
) -> dict[str, Any]:
    """Learn a model of each posture and write it.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        out: The file to write.
        mode: How clips are tracked; None: in the recogniser's own mode.
        console: For progress and warnings.
        recognizer: Which kind of model.
        cache: Folder that keeps what tracking made of clips.

    Raises:
        RecordingError: When a folder is neither, or names no posture.
        ClipsFailed: When clips cannot be used.
        TrainingError: When nothing can be learnt, or the file cannot be written.
    """
    learnt: dict[str, list[Any]] = defaultdict(list)
    performers = set()
    with spread(""):
        given = recordings(paths, mode or recognizer, cache, console)
    for recording in given:
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
