"""Teaching a model one more posture, or one of its own again, with a few takes."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from rich.console import Console

from common.npz_file import Facts
from lab.posture_models.lesson import LEAST_TAKES, Lesson, taught
from lab.training.recordings import recordings
from lab.training.training import Plan, TrainingError, model_named
from recognizer.model_file import ModelError, load, save
from recognizer.postures import PostureModel
from runtime.store.cores import spread
from runtime.terminal import counted

NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,39}")


def teach(posture: str, paths: Sequence[Path], out: Path, plan: Plan, console: Console) -> Facts:
    """Train a posture on takes, report their agreement, and write the model.

    Args:
        posture: Its name; the clips' labels are ignored.
        paths: Clip folders or run folders, one per take.
        out: The file to write.
        plan: The model to extend, and how clips are tracked.
        console: Shows progress and warnings.

    Raises:
        TrainingError: When the name is invalid, there are too few takes, one is named twice, the
            file has postures that would be lost, or it exists and is no model.
        RecordingError, ClipsFailed: When a take cannot be used.
        LearningError: When the takes do not agree.
        ModelError: When the file cannot be written, or the model to add to cannot be read.
    """
    known = model_to_teach(posture, plan, out)
    twice = [path for path, times in Counter(path.resolve() for path in paths).items() if times > 1]
    if twice:
        raise TrainingError(f"{twice[0]} is named twice: each take is a performance of its own")
    if len(paths) < LEAST_TAKES:  # before any is tracked
        raise TrainingError(
            f"{counted(len(paths), 'take')}: name at least {LEAST_TAKES} clips of {posture}"
        )
    with spread(""):
        takes = recordings(paths, known.card.recognizer, plan.cache, console, posture)
    performers = sorted({take.performer for take in takes if take.performer})
    lesson = taught(known, posture, [take.rows for take in takes], performers)
    return kept(lesson, posture, [take.clip for take in takes], out, plan)


def model_to_teach(posture: str, plan: Plan, out: Path) -> PostureModel:
    """The model to extend.

    Raises:
        TrainingError: When the name is invalid, exists although it must not, or is missing although
            it must exist; or when `out` has postures that would be lost, or is another file.
        ModelError: When it cannot be read.
    """
    if not NAME.fullmatch(posture):
        raise TrainingError(
            f"{posture!r} is no name of a posture: small letters, digits and _, as star_jump"
        )
    known = model_named(plan.add_to or Path("shipped"), plan.recognizer)
    if posture in known.names and not plan.again:
        raise TrainingError(
            f"{posture} is known already: --again learns it anew from these takes alone, or choose"
            " another name"
        )
    if plan.again and posture not in known.names:
        raise TrainingError(
            f"{posture} cannot be learnt again: {plan.add_to} (--add-to) knows"
            f" {', '.join(known.names)}"
        )
    kept_names = (*known.names, posture)
    lost = [name for name in _known_by(out) if name not in kept_names] if out.exists() else []
    if lost:
        raise TrainingError(
            f"{out} knows {', '.join(lost)}, which would be lost: keep it with --add-to {out}, or"
            " name another --out"
        )
    return known


def _known_by(out: Path) -> tuple[str, ...]:
    """The postures of an existing model file; another file is not replaced by one."""
    try:
        return load(out).names
    except ModelError as error:
        raise TrainingError(
            f"{out} is there already, and is no model that can be read: name another --out"
        ) from error


def kept(lesson: Lesson, posture: str, takes: Sequence[str], out: Path, plan: Plan) -> Facts:
    """Write the model; returns the command's output.

    Raises:
        ModelError: When the file cannot be written.
    """
    save(lesson.model, out)
    return {
        "model": str(out),
        "posture": posture,
        "again": plan.again,
        "takes": [
            {"clip": take, "margin": told.margin, "rival": told.rival}
            for take, told in zip(takes, lesson.takes, strict=True)
        ],
        "rivals": rivals(lesson),
        "knows": list(lesson.model.names),
    }


def rivals(lesson: Lesson) -> list[str]:
    """The postures most similar to the taught one, the most similar take first."""
    near = sorted(lesson.takes, key=lambda take: take.margin)
    return list(dict.fromkeys(take.rival for take in near))


def line(facts: Facts) -> str:
    """The result in words."""
    mistaken = [take for take in facts["takes"] if take["margin"] <= 0.0]
    told = [
        f"{facts['posture']} learnt {'again ' * facts['again']}from {len(facts['takes'])} takes,"
        f" {len(facts['knows'])} postures known; written to {facts['model']}"
    ]
    told += [
        f"{take['clip']} was taken for {take['rival']} by what the other takes teach:"
        " record it again"
        for take in mistaken
    ]
    if not mistaken:
        told.append(
            "each take is known again by what the others teach; the nearest other posture is"
            f" {facts['rivals'][0]}"
        )
    return "\n".join(told)
