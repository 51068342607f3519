"""Evaluation of tracking against ground truth: all accuracy figures, as a report."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from common.body.body import Bdp
from common.config import config_file
from common.config.renamed_settings import settings_of
from common.config.settings import Settings
from common.method import Mode
from common.npz_file import Arrays, DamagedFile, Facts, read_arrays
from lab.accuracy import accuracy_plots, accuracy_report, worst_frames
from lab.accuracy.accuracy import Compared, Mismatch, compare, per_joint, summary
from lab.accuracy.identity import Counts, counts, figures, gaps_of
from lab.accuracy.limb_lengths import length_errors
from lab.accuracy.people_apart import apart
from lab.accuracy.reliability import trust
from lab.accuracy.silhouette_iou import Overlap, overlaps
from runtime.offline.batch import Asked, track_all
from runtime.offline.lockstep import Decoders
from runtime.store.clip_paths import run_names, without_plain_files
from runtime.terminal import bar, json_text, warn

MAX_BYTES: Final = 1 << 30
"""Upper bound of a run and of a ground truth, bytes."""
IN_POSES: Final = ("frame", "joints_m", "joint_names", "confidence")
IN_TRUTH: Final = ("present", "joints3d", "joint_names")


class EvaluationError(ValueError):
    """A run or a ground truth that cannot be scored; the text names it and the cure."""


class Case(NamedTuple):
    """One tracked clip, and its ground truth."""

    settings: Settings
    """The run's settings."""
    performer: str
    posture: str
    bdp: Bdp | None
    """The measured body; None where no person was seen."""
    compared: Compared
    truth: Arrays


def evaluate_tracking(
    paths: Sequence[Path],
    out: Path,
    runs: Path | None,
    mode: Mode | None,
    size: str | None,
    console: Console,
) -> Facts:
    """Score clips with ground truth, and write `report.json`, `report.html` and their pictures.

    Args:
        paths: Clip folders, settings files of clips, or run folders; a run and a clip of one name
            belong together, and a run alone names its clip.
        out: Folder of the report; created where missing.
        runs: Folder of runs by the names of their clips: existing ones are read, the others are
            tracked into it. None: all clips are tracked again, into `runs` within `out`.
        mode: Mode for tracking; None: that of the settings.
        size: As `mode`.
        console: Shows progress and warnings.

    Returns:
        The content of `report.json`.

    Raises:
        EvaluationError: When nothing can be scored, or the report cannot be written.
        ClipError, ClipsFailed: When a clip cannot be used.
    """
    folders = _runs_of(paths, out, runs, mode, size, console)
    with bar(console) as progress:
        cases: dict[str, Case] = {}
        identities: dict[str, Counts] = {}
        for name, (folder, clip) in progress.track(folders.items(), description="reading"):
            found, kept_apart = _cases(folder, clip, mode, size)
            cases |= {f"{name}{whose}": case for whose, case in found.items()}
            if len(found) > 1:
                identities[name] = kept_apart
    if not any(len(case.compared.rows) for case in cases.values()):
        raise EvaluationError("no clip has both a truth.npz and a pose: there is nothing to score")
    try:
        out.mkdir(parents=True, exist_ok=True)
        report = _report(cases, out, console)
        if identities:
            report["identities"] = _identities(identities)
        (out / "report.json").write_text(json_text(report) + "\n")
        (out / "report.html").write_text(accuracy_report.page_of(report))
    except OSError as error:
        raise EvaluationError(f"cannot write into {out}: {error}; name another --out") from error
    return report


def _runs_of(
    paths: Sequence[Path],
    out: Path,
    runs: Path | None,
    mode: Mode | None,
    size: str | None,
    console: Console,
) -> dict[str, tuple[Path, Path | None]]:
    """The run folder of every name, tracked now where missing, and its clip where given.

    A clip without ground truth is reported and left out.
    """
    given = without_plain_files(paths, console)
    stand = run_names([path for path in given if _is_run(path)])
    clips = run_names([path for path in given if not _is_run(path)])
    for name in [
        name for name, path in clips.items() if not _truth_of(config_file.load(path)).is_file()
    ]:
        warn(console, f"{clips.pop(name)} has no truth.npz: left out")
    into = runs or out / "runs"
    if runs is not None:
        stand = {name: runs / name for name in clips if _is_run(runs / name)} | stand
    missing = [path for name, path in clips.items() if name not in stand]
    if missing:
        track_all(missing, into, Asked(mode, size, force=True), console)
    return {
        name: (stand.get(name, into / name), clips.get(name)) for name in sorted({*stand, *clips})
    }


def _is_run(path: Path) -> bool:
    return (path / "poses.npz").is_file()


def _truth_of(settings: Settings) -> Path:
    return Path(settings.clip) / "truth.npz"


def _cases(
    run: Path, clip: Path | None, mode: Mode | None, size: str | None
) -> tuple[dict[str, Case], Counts]:
    """A run with its ground truth: a case of each person by what their names add to the clip's,
    and how well they are kept apart."""
    try:
        facts = json.loads((run / "summary.json").read_text())
        settings = settings_of(facts["settings"])
        bdp = msgspec.convert(facts["bdp_m"], Bdp | None)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise EvaluationError(f"{run} is no run folder: {error}; track the clip again") from error
    for what, wanted, was in (("mode", mode, settings.mode), ("size", size, settings.size)):
        if wanted not in (None, was):
            raise EvaluationError(
                f"{run} was tracked with {what} {was}, not {wanted}: name another --runs"
            )
    if clip is not None:
        settings = msgspec.structs.replace(settings, clip=config_file.load(clip).clip)
    path = _truth_of(settings)
    if not path.is_file():
        raise EvaluationError(f"{run} needs {path}, which is not there: name its clip beside it")
    poses, truth = _arrays(run / "poses.npz", IN_POSES), _arrays(path, IN_TRUTH)
    try:
        gaps = gaps_of(poses, truth)
        each = [(compare(*one), one.truth) for one in apart(poses, truth, gaps)]
    except Mismatch as error:
        raise EvaluationError(f"{run} and {path} do not fit together: {error}") from error
    if len(each) == 1:
        told = facts.get("performer", ""), facts.get("posture_meant", "")
        return {"": Case(settings, *told, bdp, *each[0])}, counts(gaps)
    names = [str(name) for name in truth["performer"]]
    return {
        f", person {who}": Case(settings, names[who], "scene", None, *one)
        for who, one in enumerate(each)
    }, counts(gaps)


def _identities(clips: Mapping[str, Counts]) -> Facts:
    """How well people are kept apart, of all clips and of each."""
    per_clip = {name: figures([one]) for name, one in clips.items()}
    return {"all": figures([*clips.values()]), "per_clip": per_clip}


def _arrays(path: Path, needed: Sequence[str]) -> Arrays:
    try:
        held = read_arrays(path, MAX_BYTES)
    except (OSError, DamagedFile) as error:
        raise EvaluationError(f"cannot read {path}: {error}; make it again") from error
    missing = [name for name in needed if name not in held]
    if missing:
        raise EvaluationError(f"{path} has no {missing[0]}: make it again")
    return held


def _report(cases: Mapping[str, Case], out: Path, console: Console) -> Facts:
    clips = [case.compared for case in cases.values()]
    report: Facts = {
        "mode": sorted({case.settings.mode for case in cases.values()}),
        "size": sorted({case.settings.size for case in cases.values()}),
        "all": summary(clips),
        "per_joint": per_joint(clips),
        "per_performer": _grouped(cases, lambda case: case.performer),
        "per_posture": _grouped(cases, lambda case: case.posture),
        "per_clip": {name: summary([case.compared]) for name, case in cases.items()},
        "lengths": length_errors(clips, [case.bdp for case in cases.values()]),
        "confidence": trust(clips),
    }
    with Decoders() as decoders, bar(console) as progress:
        report["silhouettes"] = _silhouettes(
            cases,
            {
                name: overlaps(case.settings, case.truth, decoders)
                for name, case in progress.track(cases.items(), description="silhouettes")
            },
        )
        compared = {name: case.compared for name, case in cases.items()}
        truths = {name: case.truth for name, case in cases.items()}
        settings = {name: case.settings for name, case in cases.items()}
        shown = worst_frames.worst(compared)
        report["worst"] = worst_frames.draw(shown, compared, truths, settings, out, decoders)
    report["plots"] = accuracy_plots.plot_all(clips, report, out)
    return report


def _grouped(cases: Mapping[str, Case], key: Callable[[Case], str]) -> dict[str, Facts]:
    groups: dict[str, list[Compared]] = {}
    for case in cases.values():
        groups.setdefault(key(case), []).append(case.compared)
    return {name: summary(group) for name, group in sorted(groups.items())}


def _silhouettes(cases: Mapping[str, Case], found: Mapping[str, Mapping[str, Overlap]]) -> Facts:
    """Mean IoU of every clip and view, by performer, and of all; `worst` is the smallest of any
    view.

    Clips whose ground truth has no masks are left out.
    """
    per_clip: dict[str, dict[str, float]] = {}
    per_performer: dict[str, list[float]] = {}
    for name, views in [(name, views) for name, views in found.items() if views]:
        means = {view: _mean(overlap.iou) for view, overlap in views.items()}
        per_clip[name] = {**means, "both": _mean(list(means.values()))}
        per_performer.setdefault(cases[name].performer, []).append(per_clip[name]["both"])
    both = [one["both"] for one in per_clip.values()]
    every = [overlap for views in found.values() for overlap in views.values()]
    empty = sum(overlap.empty for overlap in every)
    return {
        "mean": _mean(both),
        "worst": min((min(one.values()) for one in per_clip.values()), default=np.nan),
        "ghost": sum(overlap.ghosts for overlap in every) / empty if empty else np.nan,
        "per_performer": {name: _mean(some) for name, some in sorted(per_performer.items())},
        "per_clip": per_clip,
    }


def _mean(values: NDArray[np.float64] | list[float]) -> float:
    return float(np.mean(values)) if len(values) else np.nan
