"""How well postures of people never learnt from are named: the paper's experiment (P56-P60)."""

import time
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final, NamedTuple

from rich.console import Console

from common.config import Mode
from recognizer.evaluation import (
    Fold,
    Outcome,
    Recording,
    folds,
    named_by,
    recognise,
    refuse_who_was_learnt_from,
)
from recognizer.model_file import load
from recognizer.postures import PostureModel, Recognizer
from tritrack.cores import made, spread
from tritrack.performances import recordings
from tritrack.posture_page import page_of
from tritrack.posture_report import result_of
from tritrack.terminal import bar, json_text
from tritrack.training import TrainingError

EACH_IN_TURN: Final = "leave-one-performer-out"
"""The split in which everybody is named by a model of all others."""

KINDS: Final[dict[str, tuple[Recognizer, ...]]] = {
    "both": ("default", "paper"),
    "default": ("default",),
    "paper": ("paper",),
}
"""Which recognisers stand side by side, by what a command line calls them."""


class Plan(NamedTuple):
    """What is evaluated, and how."""

    split: str = EACH_IN_TURN
    """EACH_IN_TURN, or performers to learn from and to test on: "r01,r04:r07", "s1*:s2*"."""
    recognizers: tuple[Recognizer, ...] = KINDS["both"]
    mode: Mode | None = None
    """How clips are tracked; None: in each recogniser's own mode."""
    model: Path | None = None
    """Names all clips instead of what would be learnt from some of them."""
    cache: Path = Path("runs/tracked")
    dask: str = ""
    """A cluster's address; "" for the cores of this machine."""


class Job(NamedTuple):
    """One model to be made and asked."""

    fold: Fold
    recognizer: Recognizer
    beside: bool
    """Part of what stands beside the headline."""


def evaluate_postures(
    paths: Sequence[Path], out: Path, plan: Plan, console: Console
) -> dict[str, Any]:
    """Train and test by a split, and write `report.json` and `report.html`.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        out: Folder of the report; made where it is not there.
        plan: What is evaluated.
        console: For progress and warnings.

    Returns:
        What `report.json` holds.

    Raises:
        TrainingError: When nothing can be learnt or tested, or the report cannot be written.
        RecordingError: When a folder is neither clip nor run, or names no posture.
        ClipsFailed: When clips cannot be used.
        ModelError: When the plan's model cannot.
        ClusterError: When the plan's cluster cannot.
    """
    model = load(plan.model) if plan.model else None
    kinds = (model.card.recognizer,) if model else plan.recognizers
    results = {}
    try:
        with spread(plan.dask):
            for kind in kinds:
                results[kind] = _result(paths, kind, model, plan, console)
        report = {
            "split": plan.split if model is None else f"named by {plan.model}",
            "clips": len(paths),
            "recognizers": results,
        }
        out.mkdir(parents=True, exist_ok=True)
        (out / "report.json").write_text(json_text(report) + "\n")
        (out / "report.html").write_text(page_of(report))
    except (ValueError, OSError) as error:
        raise TrainingError(f"cannot evaluate into {out}: {error}") from error
    return report


def _result(
    paths: Sequence[Path],
    kind: Recognizer,
    model: PostureModel | None,
    plan: Plan,
    console: Console,
) -> dict[str, Any]:
    """All that is said of one recogniser."""
    began = time.perf_counter()
    given = recordings(paths, plan.mode or kind, plan.cache, console)
    read = time.perf_counter()
    if model is None:
        outcomes, beside = _judged(_jobs(given, plan.split, kind), console)
    else:
        refuse_who_was_learnt_from(model.card.performers, given)
        outcomes, beside = named_by(model, given), []
    done = time.perf_counter()
    return {
        "mode": plan.mode or kind,
        **result_of(outcomes),
        "within_test": result_of(beside) if beside else None,
        "seconds": {
            "tracking": round(read - began, 2),
            "learning and naming": round(done - read, 2),
        },
    }


def _jobs(given: list[Recording], split: str, kind: Recognizer) -> list[Job]:
    """The headline's, and leave-one-performer-out within the test set beside it."""
    if split == EACH_IN_TURN:
        if len({one.performer for one in given}) < 2:
            raise ValueError("one performer alone: nobody is left to learn from")
        return [Job(fold, kind, False) for fold in folds(given)]
    learnt, colon, tested = split.partition(":")
    parts = _of(given, learnt), _of(given, tested)
    if not colon or not all(parts):
        raise ValueError(
            f"the split {split!r} must be {EACH_IN_TURN} or name performers that are there, "
            f"to learn from and to test on, as in r01,r04:r07"
        )
    alone = len({one.performer for one in parts[1]}) < 2
    beside = [] if alone else [Job(fold, kind, True) for fold in folds(parts[1])]
    return [Job(parts, kind, False), *beside]


def _of(given: list[Recording], people: str) -> list[Recording]:
    wanted = [pattern.strip() for pattern in people.split(",")]
    return [one for one in given if any(fnmatchcase(one.performer, name) for name in wanted)]


def _judged(jobs: Sequence[Job], console: Console) -> tuple[list[Outcome], list[Outcome]]:
    """The headline's outcomes and those beside it, whoever was done first."""
    headline: list[Outcome] = []
    beside: list[Outcome] = []
    with bar(console) as progress:
        answers: Iterable[tuple[bool, list[Outcome]]] = progress.track(
            made(_answered, jobs), total=len(jobs), description="learning"
        )
        for is_beside, outcomes in answers:
            (beside if is_beside else headline).extend(outcomes)
    return sorted(headline, key=_place), sorted(beside, key=_place)


def _answered(job: Job) -> tuple[bool, list[Outcome]]:
    return job.beside, recognise(*job.fold, job.recognizer)


def _place(one: Outcome) -> tuple[str, str, str]:
    return one.performer, one.truth, one.clip
