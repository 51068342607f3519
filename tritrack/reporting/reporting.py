"""A run's report: the overlay of its views, the plot of its angles, and `report.html`."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from rich.console import Console

from animator.h264_file import is_h264
from animator.report.belief_stretches import worst_rows
from animator.report.report_page import ReportInput, person_part, report_html
from common.atomic_file import replacing
from common.npz_file import Facts
from common.video.pictures import DecoderDied, Undecodable
from runtime.store.past_run import PastRun, open_run
from runtime.store.run_people import of_person, people_of
from runtime.store.runs import unwritable
from runtime.terminal import Tell, bar, by_share, warn
from tritrack.reporting.report_words import clock_line, facts_of, trust_lines
from tritrack.reporting.run_angles import courses_of
from tritrack.reporting.run_overlay import Drawn, draw
from tritrack.reporting.run_pictures import NoPictures
from tritrack.single.angle_plot import angle_plot

REPORT: Final = "report.html"
MOST_SHOTS: Final = 6
"""Number of frames shown as pictures, of each person."""
APART_S: Final = 0.5
"""Least time between two of them, seconds."""


class _Person(NamedTuple):
    """One person of a run."""

    title: str
    run: PastRun
    worst: list[int]
    """The least believable rows of the whole run that are this person's."""


def report_all(folders: Sequence[Path], console: Console) -> Facts:
    """Write the report of run after run.

    Raises:
        PastRunError: When one is no run, or is damaged.
        RunError, VideoError: When a file cannot be written.
    """
    made: Facts = {}
    with bar(console) as progress:
        for folder, tell in by_share(progress, folders, "drawing"):
            made[str(folder)] = report_run(folder, console, tell)
    return {"reports": made}


def report_run(folder: Path, console: Console, tell: Tell) -> Facts:
    """Write a run's overlay of its views, the plot of its angles and the report page.

    Where its videos are not there any more, the page has no pictures, and a warning says why.

    Args:
        folder: The run's.
        console: Shows warnings.
        tell: Receives the share that is done.

    Raises:
        PastRunError: When it is no run, or is damaged.
        RunError, VideoError: When a file cannot be written.
    """
    run = open_run(folder)
    people = [_person(run, number) for number in people_of(run.poses)]
    drawn = _drawn(run, {row for each in people for row in each.worst}, console, tell)
    parts = [
        person_part(
            each.title,
            each.run.poses,
            courses_of(each.run.poses),
            [drawn.shots[row] for row in each.worst if row in drawn.shots],
        )
        for each in people
    ]
    html = report_html(_input_of(run, drawn.video), parts)
    try:
        if find_spec("matplotlib") is not None:
            _write(folder / "angles.png", angle_plot(people[0].run.poses))
        _write(folder / REPORT, html.encode(errors="replace"))
    except OSError as error:
        raise unwritable(folder, error) from error
    return {"report": str(folder / REPORT), "overlay": drawn.video}


def _person(run: PastRun, number: int) -> _Person:
    own = of_person(run, number)
    rows = np.flatnonzero(run.poses["person"] == number)
    worst = rows[worst_rows(own.poses, MOST_SHOTS, APART_S)].tolist()
    return _Person(f"Person {number}" if number else "", own, worst)


def _drawn(run: PastRun, wanted: set[int], console: Console, tell: Tell) -> Drawn:
    try:
        return draw(run, wanted, tell)
    except (NoPictures, DecoderDied, Undecodable) as error:
        warn(console, f"{run.folder.name}: {error}")
        return Drawn("", {})


def _input_of(run: PastRun, video: str) -> ReportInput:
    summary = run.summary
    of = summary.get("run_of") or {}
    return ReportInput(
        name=str(summary.get("clip") or run.folder.resolve().name),
        facts=facts_of(run),
        trust=[*trust_lines(summary), *clock_line(summary)],
        warnings=[str(one) for one in summary.get("warnings", ())],
        video=video,
        plays=bool(video) and is_h264(run.folder / video),
        command=f"tritrack {of.get('command', 'track')}",
    )


def _write(path: Path, content: bytes) -> None:
    with replacing(path) as new:
        new.write_bytes(content)
