"""Evaluation on uncut streams: performances found, delays, false events."""

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from common.config import config_file
from common.config.part_settings import RecognizerSettings
from common.method import Mode
from common.npz_file import Arrays, Facts
from common.video.clips import meta_of
from lab.posture_models.evaluation import wilson
from lab.posture_models.streams import Act, Found, Stream, found, joined
from lab.training.training import TrainingError
from recognizer.__main__ import MOVING, SHIPPED
from recognizer.features import Rows, rows
from recognizer.model_file import load
from recognizer.model_rate import PERIOD_S, counts
from recognizer.postures import DensityModel
from runtime.offline.lockstep import Decoders, track_clip
from runtime.overrides import overridden
from runtime.store.clip_paths import without_plain_files
from runtime.store.past_run import PastRunError, is_run, open_run
from runtime.store.pose_arrays import poses
from runtime.terminal import bar, json_text

SEED: Final = 0
"""Seed of the order in which single performances are joined."""


def evaluate_spotting(
    paths: Sequence[Path], out: Path, model: Path | None, mode: Mode | None, console: Console
) -> Facts:
    """Find performances in streams, and write `spotting.json`.

    Args:
        paths: Clips or runs whose `acts` give the performances' times (`tritrack synth --motion
            stream` makes such), or which show one posture each: these are joined to a stream per
            performer.
        out: Folder of the report; created where missing.
        model: A model file; None: the one in the package.
        mode: Mode for tracking; None: that of the settings.
        console: Shows progress and warnings.

    Returns:
        The file's content, and the table as text.

    Raises:
        TrainingError: When a folder is no stream, the model is the paper's, or the report cannot be
            written.
        ModelError: When the model cannot be used.
        ClipError: When a clip cannot be used.
    """
    learnt = load(model or SHIPPED)
    if not isinstance(learnt, DensityModel):
        raise TrainingError(f"{model} is the paper's recogniser: it names what was cut out for it")
    results = [found(learnt, stream) for stream in streams(paths, mode, console)]
    report = _report(results)
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / "spotting.json").write_text(json_text(report) + "\n")
    except OSError as error:
        raise TrainingError(f"cannot write {out}: {error.strerror}; name another --out") from error
    return report


def streams(paths: Sequence[Path], mode: Mode | None, console: Console) -> list[Stream]:
    """The streams of clips or runs; single performances are joined, performer by performer."""
    whole: list[Stream] = []
    single: dict[str, list[tuple[str, Rows]]] = defaultdict(list)
    folders = without_plain_files(paths, console)
    for path in folders:
        _refuse_nameless(path)
    with Decoders() as decoders, bar(console) as progress:
        for path in progress.track(folders, description="reading"):
            facts, arrays = _run(path) if is_run(path) else _clip(path, mode, decoders)
            often = counts(arrays["time_s"])
            seen = np.repeat(_rows(arrays), often, axis=0)
            if "acts" in facts:
                acts = tuple(_counted(Act(**act), often) for act in facts["acts"])
                whole.append(Stream(path.name, seen, acts))
            else:
                cut = seen[-RecognizerSettings().window_frames :]
                single[facts.get("performer", "")].append((facts["posture_meant"], cut))
    return [*whole, *(joined(who, given, SEED) for who, given in sorted(single.items()))]


def _refuse_nameless(path: Path) -> None:
    """Raise before anything is tracked."""
    if is_run(path):
        facts = _run(path)[0]
        named = "acts" in facts or facts.get("posture_meant")
    else:
        meta = meta_of(config_file.load(path))
        named = meta.acts or meta.posture
    if not named:
        raise TrainingError(f"{path} names neither acts nor a posture in its meta.json")


def _clip(path: Path, mode: Mode | None, decoders: Decoders) -> tuple[Facts, Arrays]:
    tracked = track_clip(overridden(config_file.load(path), mode, None), decoders)
    return tracked.facts, poses(tracked.bodies)


def _run(path: Path) -> tuple[Facts, Arrays]:
    try:
        run = open_run(path)
    except PastRunError as error:
        raise TrainingError(str(error)) from error
    return run.summary, run.poses


def _counted(act: Act, often: NDArray[np.int64]) -> Act:
    """A performance in frames of its clip, converted to model frames."""
    at = np.cumsum(often) - 1
    first, last = (int(at[min(frame, len(at) - 1)]) for frame in (act.first, act.last))
    return act._replace(first=first, last=last)


def _rows(arrays: Arrays) -> Rows:
    tracked = rows(arrays["angles_deg"], arrays["joints_m"])
    return np.where(np.isin(arrays["status"], MOVING)[:, np.newaxis], tracked, np.nan)


def _report(results: Sequence[Found]) -> Facts:
    performances = sum(one.performances for one in results)
    delays_s = PERIOD_S * np.array([delay for one in results for delay in one.delays])
    minutes = sum(one.frames for one in results) * PERIOD_S / 60.0
    false = sum(len(one.false) for one in results)
    report = {
        "performances": performances,
        "found": len(delays_s),
        "share": len(delays_s) / performances if performances else 0.0,
        "interval_95": wilson(len(delays_s), performances),
        "minutes": minutes,
        "false_alarms": false,
        "false_alarms_a_minute": false / minutes if minutes else 0.0,
        "latency_median_s": float(np.median(delays_s)) if len(delays_s) else None,
        "latency_p90_s": float(np.percentile(delays_s, 90)) if len(delays_s) else None,
        "streams": [
            {
                "name": one.stream,
                "performances": one.performances,
                "missed": [act._asdict() for act in one.missed],
                "false": [event._asdict() for event in one.false],
            }
            for one in results
        ],
    }
    return {**report, "table": _table(report)}


def _table(report: Facts) -> str:
    lines = []
    for one in report["streams"]:
        lines += [f"{one['name']}: missed {act['name']} at {act['first']}" for act in one["missed"]]
        lines += [f"{one['name']}: false {e['name']} at {e['first']}" for e in one["false"]]
    low, high = report["interval_95"]
    median_s, p90_s = report["latency_median_s"], report["latency_p90_s"]
    after = (
        "" if median_s is None else f", told {median_s:.2f} s after their end (90 %: {p90_s:.2f} s)"
    )
    return "\n".join(
        [
            *lines,
            f"found and named: {report['found']}/{report['performances']} = {report['share']:.1%} "
            f"(95 % interval {low:.1%} to {high:.1%}){after}",
            f"false alarms: {report['false_alarms']} in {report['minutes']:.1f} minutes, "
            f"{report['false_alarms_a_minute']:.2f} a minute",
        ]
    )
