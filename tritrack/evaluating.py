"""How well postures of people never learnt from are named: the paper's table 2, as a report."""

import html
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from common.config import Mode
from recognizer.evaluation import (
    Outcome,
    Recording,
    confusion,
    leave_one_performer_out,
    recognise,
    table,
    wilson,
)
from recognizer.postures import POSTURES, Recognizer
from tritrack.terminal import json_text
from tritrack.training import TrainingError, recordings

EACH_IN_TURN: Final = "leave-one-performer-out"
"""The split in which everybody is named by a model of all others."""

STYLE: Final = (
    "body{font:14px sans-serif;margin:2em}table{border-collapse:collapse}"
    "td,th{border:1px solid #ccc;padding:3px 8px;text-align:right}"
    "th:first-child{text-align:left}thead th{writing-mode:vertical-rl;text-align:left}"
)


def evaluate_postures(
    paths: Sequence[Path],
    out: Path,
    split: str,
    recognizer: Recognizer,
    mode: Mode | None,
    console: Console,
) -> dict[str, Any]:
    """Train and test by a split, and write `report.json` and `report.html`.

    Args:
        paths: Clip folders whose `meta.json` names posture and performer, or their run folders.
        out: Folder of the report; made where it is not there.
        split: EACH_IN_TURN, or performers to learn from and to test on: "r01,r04:r07", "s1*:s2*".
        recognizer: Which kind of model.
        mode: How clips are tracked; None: as their settings say.
        console: For progress and warnings.

    Returns:
        What `report.json` holds, and the table as text.

    Raises:
        TrainingError: When nothing can be learnt or tested, or the report cannot be written.
        ClipError: When a clip cannot be used.
    """
    given = recordings(paths, mode, console)
    try:
        outcomes = _outcomes(given, split, recognizer)
        report = _report(outcomes, split, recognizer)
        out.mkdir(parents=True, exist_ok=True)
        (out / "report.json").write_text(json_text(report) + "\n")
        (out / "report.html").write_text(page_of(report))
    except (ValueError, OSError) as error:
        raise TrainingError(f"cannot evaluate into {out}: {error}") from error
    return report


def _outcomes(given: list[Recording], split: str, recognizer: Recognizer) -> list[Outcome]:
    if split == EACH_IN_TURN:
        if len({one.performer for one in given}) < 2:
            raise ValueError("one performer alone: nobody is left to learn from")
        return list(leave_one_performer_out(given, recognizer))
    learnt, colon, tested = split.partition(":")
    parts = [_of(given, people) for people in (learnt, tested)]
    if not colon or not all(parts):
        raise ValueError(
            f"the split {split!r} must be {EACH_IN_TURN} or name performers that are there, "
            f"to learn from and to test on, as in r01,r04:r07"
        )
    return recognise(parts[0], parts[1], recognizer)


def _of(given: list[Recording], people: str) -> list[Recording]:
    wanted = [pattern.strip() for pattern in people.split(",")]
    return [one for one in given if any(fnmatchcase(one.performer, name) for name in wanted)]


def _report(outcomes: list[Outcome], split: str, recognizer: Recognizer) -> dict[str, Any]:
    seen = {one.truth for one in outcomes}
    names = [*(posture for posture in POSTURES if posture in seen), *sorted(seen - set(POSTURES))]
    counts = confusion(outcomes, names)
    correct = np.diagonal(counts)
    return {
        "recognizer": recognizer,
        "split": split,
        "all": _share(int(correct.sum()), int(counts.sum())),
        "postures": {
            posture: _share(int(right), int(row.sum()))
            for posture, right, row in zip(names, correct, counts, strict=True)
        },
        "confusion": {"named": [*names, ""], "counts": counts.tolist()},
        "table": table(counts, names),
    }


def _share(correct: int, tested: int) -> dict[str, Any]:
    """Correct of tested with Wilson's 95 % interval (P59)."""
    share = correct / tested if tested else 0.0
    return {
        "correct": correct,
        "tested": tested,
        "share": share,
        "interval_95": wilson(correct, tested),
    }


def page_of(report: dict[str, Any]) -> str:
    """The report as a page that needs nothing but itself."""
    title = f"{report['recognizer']} recogniser, {report['split']}"
    lines = [
        _line(name, result)
        for name, result in [*report["postures"].items(), ("all", report["all"])]
    ]
    named = [name or "no name" for name in report["confusion"]["named"]]
    matrix = np.array(report["confusion"]["counts"])
    head = "".join(f"<th>{html.escape(name)}</th>" for name in named)
    cells = "".join(
        f"<tr><th>{html.escape(name)}</th>{_cells(row)}</tr>"
        for name, row in zip(report["postures"], matrix, strict=True)
    )
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style><h1>Postures: {html.escape(title)}</h1>"
        "<table><tr><th>posture<th>correct<th>share<th>95 % interval"
        f"{''.join(lines)}</table><h2>Shown (row), named (column)</h2>"
        f"<table><thead><tr><th></th>{head}</tr></thead>{cells}</table></html>\n"
    )


def _line(name: str, result: dict[str, Any]) -> str:
    low, high = result["interval_95"]
    return (
        f"<tr><th>{html.escape(name)}<td>{result['correct']}/{result['tested']}"
        f"<td>{result['share']:.1%}<td>{low:.1%} to {high:.1%}"
    )


def _cells(row: NDArray[np.int64]) -> str:
    """Cells the darker the larger their share of the row."""
    shares = row / max(int(row.sum()), 1)
    return "".join(
        f'<td style="background:rgba(40,90,200,{0.7 * share:.2f})">{count or ""}</td>'
        for count, share in zip(row.tolist(), shares.tolist(), strict=True)
    )
