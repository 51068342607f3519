"""Recognition of postures of people outside the training data: the paper's experiment (P56-P60)."""

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from common.method import Mode
from common.npz_file import Facts
from lab.posture_models.evaluation import Outcome, Recording, named_by, refuse_who_was_learnt_from
from lab.postures.posture_page import page_of
from lab.postures.posture_pictures import draw_confusion, draw_worst
from lab.postures.posture_report import result_of, share
from lab.postures.posture_split import (
    EACH_IN_TURN,
    SWEPT_STATES,
    SWEPT_SYMBOLS,
    jobs_of,
    judged,
    parts_of,
    refuse_in_vain,
    sweep_of,
    swept,
)
from lab.postures.style_spread import spread_of
from lab.training.recordings import announced, recordings
from lab.training.training import TrainingError, model_named
from recognizer.postures import LEAST_FIT, PostureModel, Recognizer
from runtime.store.cores import spread
from runtime.terminal import json_text

KINDS: Final[dict[str, tuple[Recognizer, ...]]] = {
    "both": ("default", "paper"),
    "default": ("default",),
    "paper": ("paper",),
}
"""Recognisers to compare, by their names on a command line."""


class Plan(NamedTuple):
    """What is evaluated, and how."""

    split: str = EACH_IN_TURN
    """As in `experiment.jobs_of`."""
    recognizers: tuple[Recognizer, ...] = KINDS["both"]
    mode: Mode | None = None
    """Mode for tracking; None: each recogniser's own mode."""
    model: Path | None = None
    """A model to test on all clips, in place of training on some; "shipped": those in the
    package."""
    sweep: bool = False
    """True: the paper's recogniser in other sizes too."""
    cache: Path = Path("runs/.tracked")
    dask: str = ""
    """A cluster's address; "" for the cores of this machine."""


def evaluate_postures(paths: Sequence[Path], out: Path, plan: Plan, console: Console) -> Facts:
    """Train and test by a split, and write `report.json`, `report.html` and its pictures.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        out: Folder of the report; created where missing.
        plan: What is evaluated.
        console: Shows progress and warnings.

    Returns:
        The content of `report.json`.

    Raises:
        TrainingError, LearningError: When there is nothing to train or test on, which the clips'
            own data show before tracking; or when the report cannot be written.
        RecordingError: When a folder is neither clip nor run, or names no posture.
        SettingsError, ClipError, ClipsFailed: When clips cannot be used.
        ModelError: When the plan's model cannot be used.
        ClusterError: When the plan's cluster cannot be used.
    """
    models = _models(plan)
    given = announced(paths, console)
    clips = [Path(one.clip) for one in given]
    _refuse_in_vain(given, models, plan)
    report: Facts = {"split": f"{plan.model} models" if plan.model else plan.split}
    with spread(plan.dask):
        for kind, model in models.items():
            mode = plan.mode or kind
            given = recordings(clips, mode, plan.cache, console)
            report |= {"clips": len(given), "people": _people(given, plan)}
            result = _result(given, kind, model, plan, console)
            report.setdefault("recognizers", {})[kind] = {"mode": mode, **result}
        if plan.sweep and plan.model is None:
            given = recordings(clips, plan.mode or "paper", plan.cache, console)
            report["sweep"] = _swept(given, plan, console)
    try:
        out.mkdir(parents=True, exist_ok=True)
        _write(report, out)
    except OSError as error:
        raise TrainingError(f"cannot write {out}: {error.strerror}; name another --out") from error
    return report


def _models(plan: Plan) -> dict[Recognizer, PostureModel | None]:
    """The model of each kind; None where it must be trained."""
    if plan.model is None:
        return dict.fromkeys(plan.recognizers)
    given = [model_named(plan.model, kind) for kind in plan.recognizers]
    return {model.card.recognizer: model for model in given}


def _refuse_in_vain(
    given: Sequence[Recording], models: Mapping[Recognizer, PostureModel | None], plan: Plan
) -> None:
    """Refuse, before the work, a plan that would measure nothing."""
    for model in models.values():
        if model is None:
            refuse_in_vain(given, plan.split)
        else:
            refuse_who_was_learnt_from(model.card.performers, given)
            if not {one.posture for one in given} & set(model.names):
                raise TrainingError(f"{plan.model} knows none of the postures of these clips")


def _result(
    given: list[Recording],
    kind: Recognizer,
    model: PostureModel | None,
    plan: Plan,
    console: Console,
) -> Facts:
    """The report on one recogniser."""
    began = time.perf_counter()
    groups: dict[str, list[Outcome]]
    if model is None:
        groups = judged(list(jobs_of(given, plan.split, kind)), console)
    else:
        groups = {"headline": named_by(model, given)}
    within = groups.get("within test")
    return {
        **result_of(groups["headline"], LEAST_FIT[kind]),
        "within_test": result_of(within, LEAST_FIT[kind]) if within else None,
        "learning_s": round(time.perf_counter() - began, 2),
    }


def _swept(given: list[Recording], plan: Plan, console: Console) -> Facts:
    """Correct results of each size: a row per number of symbols, a column per number of states."""
    groups = judged(list(sweep_of(given, plan.split)), console)
    shares = [
        [share(groups[swept(symbols, states)]) for states in SWEPT_STATES]
        for symbols in SWEPT_SYMBOLS
    ]
    return {"symbols": SWEPT_SYMBOLS, "states": SWEPT_STATES, "shares": shares}


def _people(given: Sequence[Recording], plan: Plan) -> Facts:
    """Training people, tested people, and the range of each group's styles."""
    parts = None if plan.model else parts_of(given, plan.split)
    groups = {"tested": given} if parts is None else {"learnt from": parts[0], "tested": parts[1]}
    return {
        name: {
            "performers": sorted({one.performer for one in group}),
            "clips": len(group),
            "styles": spread_of(group),
        }
        for name, group in groups.items()
    }


def _write(report: Facts, out: Path) -> None:
    for kind, result in report["recognizers"].items():
        result["picture"] = f"confusion_{kind}.png"
        draw_confusion(result, f"{kind} recogniser", out / result["picture"])
        draw_worst(result, result["mode"], out, f"worst_{kind}")
    (out / "report.json").write_text(json_text(report) + "\n")
    (out / "report.html").write_text(page_of(report, out))
