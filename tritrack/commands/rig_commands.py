"""The calibrate commands: where the cameras are, from line markers, then from poles (4.1)."""

from pathlib import Path
from typing import Annotated

import typer

from tritrack.commands.command_output import JsonWanted, console, tell_rows
from tritrack.commands.options import writable_file

calibrate_app = typer.Typer(
    help="Find out where the cameras are: from line markers, then from poles (section 4.1).",
    no_args_is_help=True,
)


@calibrate_app.command()
def markers(
    measured: Annotated[Path, typer.Argument(help="Points on the line markers (TOML).")],
    json_wanted: JsonWanted = False,
) -> None:
    """Say how far each camera is turned, tilted and rolled away from the marked lines.

    Example: tritrack calibrate markers configs/markers.toml
    """
    from integrator.rig.calibration import run_markers

    tell_rows(run_markers(measured), json_wanted)


@calibrate_app.command()
def poles(
    measured: Annotated[Path, typer.Argument(help="Tops of the poles in both pictures (TOML).")],
    out: Annotated[Path, typer.Option(help="The file to write.", callback=writable_file)] = Path(
        "calibration.json"
    ),
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Find focal lengths and distances from poles at known places, with error bars.

    Example: tritrack calibrate poles configs/poles.toml --out clips/calibration.json
    """
    from integrator.rig.calibration import run_poles

    tell_rows(run_poles(measured, out, force).cameras, json_wanted)
    console.print(f"written to {out}", highlight=False, soft_wrap=True)
