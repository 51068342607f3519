"""The commands that make a run, or two, into a page to look at."""

from pathlib import Path
from typing import Annotated

import typer

from tritrack.commands.command_output import JsonWanted, console, tell


def report(
    runs: Annotated[list[Path], typer.Argument(help="Run folders.")],
    json_wanted: JsonWanted = False,
) -> None:
    """Make a run into a page to look at, with its video.

    In the run's folder: report.html, which loads nothing from elsewhere, the overlay of all views
    as a video, and a plot of the angles.

    Example: tritrack report runs/walk
    """
    from tritrack.reporting.reporting import report_all

    facts = report_all(runs, console)
    tell(facts, json_wanted, line_of_reports([*facts["reports"].values()]))


def line_of_reports(made: list[dict[str, str]]) -> str:
    """What was written, in one line."""
    return f"open {', '.join(each['report'] for each in made)}"


def compare(
    first: Annotated[Path, typer.Argument(help="A run folder.")],
    second: Annotated[Path, typer.Argument(help="Another run of the same clip.")],
    json_wanted: JsonWanted = False,
) -> None:
    """Compare two runs: their angles, joints, where they part.

    The page is compare.html in the folder of the first.

    Example: tritrack compare runs/walk other/walk
    """
    from tritrack.reporting.comparing import compare_runs

    facts = compare_runs(first, second)
    lines = [*facts.pop("lines"), f"open {facts['file']}"]
    tell(facts, json_wanted, "\n".join(lines))
