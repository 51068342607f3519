"""The command that writes a run for other programs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from runtime.store.run_exports import OWN_NAMES, Format
from runtime.terminal import counted
from tritrack.commands.command_output import JsonWanted, tell
from tritrack.commands.options import Forced, writable_file
from tritrack.export_formats import Scale
from tritrack.exporting import export_run


def export(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    to: Annotated[
        Format, typer.Option(help="Format, for animation, movement laboratory or spreadsheet.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"The file to write; by default in RUN: {', '.join(OWN_NAMES.values())}.",
            callback=writable_file,
        ),
    ] = None,
    scale: Annotated[Scale, typer.Option(help="Unit of a BVH file.")] = "m",
    person: Annotated[
        int | None,
        typer.Option(help="Number of the person to write; by default all, each a file."),
    ] = None,
    force: Forced = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Write a run as a file for other programs.

    Of several people each gets a file of their own: body_person2.bvh.

    Example: tritrack export runs/walk --to bvh
    """
    facts = export_run(run, to, out, scale, force, person)
    lines = [_line_of_export(each, to) for each in facts.get("people", [facts])]
    for number, why in facts.get("left_out", {}).items():
        lines.append(f"person {number} is left out: {why}")
    tell(facts, json_wanted, "\n".join(lines))


def _line_of_export(facts: Mapping[str, Any], to: Format) -> str:
    """What was written of a person."""
    off = facts.get("off_mm")
    told = f"; fixed bones: {off['median']} mm off, 95 % within {off['p95']} mm" if off else ""
    line = f"{counted(facts['frames'], 'frame')} written to {facts['file']}{told}"
    return line + line_of_gaps(facts, to)


def line_of_gaps(facts: Mapping[str, Any], to: Format) -> str:
    """A note on an export's frames without a pose."""
    if facts.get("filled"):
        return f"; {facts['filled']} without a pose lie between their neighbours"
    if not facts.get("empty"):
        return ""
    line = f"; {facts['empty']} without a pose are empty"
    if to == "trc":
        line += ", where OpenSim's inverse kinematics stops: name times between them, or use mot"
    return line
