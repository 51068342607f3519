"""Training of posture models from clips or runs."""

from collections import defaultdict
from collections.abc import Mapping, Sequence, Sized
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from common.method import Mode
from common.npz_file import Facts
from lab.posture_models.learning import train
from lab.posture_models.lesson import LEAST_TAKES
from lab.training.recordings import recordings
from recognizer.__main__ import SHIPPED, SHIPPED_PAPER
from recognizer.features import Rows
from recognizer.model_file import load, save
from recognizer.postures import PostureModel, Recognizer
from runtime.store.cores import spread
from runtime.terminal import warn

SHIPPED_MODELS: Final[dict[Recognizer, Path]] = {"default": SHIPPED, "paper": SHIPPED_PAPER}
"""The packaged models that a command line calls `shipped`, by kind."""


class TrainingError(ValueError):
    """An impossible training, test or output; the text names the cure."""


class Plan(NamedTuple):
    """What a model shall be, and how its clips are tracked."""

    mode: Mode | None
    """Mode for tracking; None: the recogniser's own mode."""
    recognizer: Recognizer
    """Kind of model."""
    cache: Path
    """Folder of cached tracking results."""
    add_to: Path = Path("shipped")
    """For teaching: the model to extend, which determines the kind."""
    again: bool = False
    """For teaching: the posture is one of that model's, to be retrained."""


def train_postures(paths: Sequence[Path], out: Path, plan: Plan, console: Console) -> Facts:
    """Train a model of each posture and write it.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        out: The file to write.
        plan: What the model shall be.
        console: Shows progress and warnings.

    Raises:
        RecordingError: When a folder is neither, or has no label.
        ClipsFailed: When clips cannot be used.
        LearningError: When there is nothing to train on.
        ModelError: When the file cannot be written.
    """
    learnt: dict[str, list[Rows]] = defaultdict(list)
    performers = set()
    with spread(""):
        given = recordings(paths, plan.mode or plan.recognizer, plan.cache, console)
    for recording in given:
        learnt[recording.posture].append(recording.rows)
        performers.add(recording.performer)
    _warn_of_few(learnt, console)
    model = train(dict(learnt), plan.recognizer, performers=sorted(performers))
    save(model, out)
    return {
        "model": str(out),
        "sequences": {name: len(given) for name, given in sorted(learnt.items())},
        "performers": sorted(performers),
        "knows": list(model.names),
    }


def _warn_of_few(learnt: Mapping[str, Sized], console: Console) -> None:
    """Warn about training data that are too few to distinguish postures."""
    if len(learnt) == 1:
        warn(
            console,
            f"only {next(iter(learnt))} is learnt: such a model names any motion so; name clips of "
            "others, or add it to a model: tritrack teach",
        )
    few = [name for name, takes in sorted(learnt.items()) if len(takes) < LEAST_TAKES]
    if few:
        warn(
            console,
            f"less than {LEAST_TAKES} takes of {', '.join(few)}: record more, of several people",
        )


def model_named(path: Path, recognizer: Recognizer) -> PostureModel:
    """The model in a file, or the packaged one where the path is `shipped`.

    Raises:
        ModelError: When it cannot be read.
    """
    return load(SHIPPED_MODELS[recognizer] if path == Path("shipped") else path)
