"""The front door: every command of tritrack."""

import json
import logging
import os
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import typer
from rich.console import Console

from common import config
from common.config import Settings
from common.messages import ViewerNumber

OURS = ("animator", "common", "integrator", "recognizer", "synth", "tritrack", "viewer")

VIEWERS: dict[str, tuple[ViewerNumber, ...]] = {"12": (1, 2), "1": (1,), "2": (2,)}

app = typer.Typer(
    name="tritrack",
    help="Body tracking and posture recognition from two ordinary cameras, in real time.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
calibrate_app = typer.Typer(
    help="Find out where the cameras are: from line markers, then from poles (section 4.1).",
    no_args_is_help=True,
)
app.add_typer(calibrate_app, name="calibrate")

console = Console(stderr=True)

ConfigPath = Annotated[Path, typer.Argument(help="A settings file (TOML), or a clip folder.")]
Out = Annotated[Path, typer.Option(help="Folder to write into.")]
JsonWanted = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
ModeName = Annotated[Literal["default", "paper"], typer.Option(help="Which method tracks.")]


@app.callback()
def every_command(
    log_level: Annotated[
        Literal["debug", "info", "warning", "error"],
        typer.Option(help="How much of the log is written."),
    ] = "warning",
) -> None:
    """Set up what all commands share."""
    os.environ["TRITRACK_LOG"] = "info" if log_level == "warning" else log_level
    logging.basicConfig(level=log_level.upper(), format="%(levelname)s %(name)s: %(message)s")


@app.command()
def demo(
    out: Out = Path("runs/demo"),
    page: Annotated[bool, typer.Option(help="Open the live page.")] = True,
    json_wanted: JsonWanted = False,
) -> None:
    """Run the whole system on a made-up person: two viewers, integrator, recognizer, page.

    Example: tritrack demo
    """
    from tritrack.demo import run_demo

    facts = run_demo(out, page, console)
    tell(facts, json_wanted, f"posture: {facts['posture']}; written to {out}")


@app.command()
def live(
    settings_file: ConfigPath,
    out: Out = Path("runs/live"),
    mode: Annotated[
        Literal["default", "paper"] | None, typer.Option(help="Instead of the settings' mode.")
    ] = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Track live: on recorded clips at their own pace, or on cameras. Ctrl-C ends it.

    Example: tritrack live configs/live.toml --out runs/monday
    """
    from tritrack.session import live as run_live

    settings = with_mode(config.load(settings_file), mode)
    facts = run_live(settings, out, console)
    tell(facts, json_wanted, f"posture: {facts['posture'] or 'none'}; written to {out}")


@app.command()
def view(
    settings_file: ConfigPath,
    viewer: Annotated[int, typer.Option(min=1, max=2, help="Which camera this process looks at.")],
) -> None:
    """Run one viewer alone, for a rig spread over hosts.

    Example: tritrack view configs/live.toml --viewer 1
    """
    from viewer.__main__ import main as viewer_main

    number: ViewerNumber = 1 if viewer == 1 else 2
    viewer_main(config.load(settings_file), number)


@app.command()
def integrate(settings_file: ConfigPath) -> None:
    """Run the integrator alone: the others connect to it.

    Example: tritrack integrate configs/live.toml
    """
    from integrator.__main__ import main as integrator_main

    settings = config.load(settings_file)
    integrator_main(settings, two_camera_clip(settings))


@app.command()
def recognize(settings_file: ConfigPath) -> None:
    """Run the recognizer alone.

    Example: tritrack recognize configs/live.toml
    """
    from recognizer.__main__ import main as recognizer_main

    settings = config.load(settings_file)
    clip = two_camera_clip(settings)
    recognizer_main(settings, clip.every / clip.views[0].fps)


@app.command()
def animate(settings_file: ConfigPath) -> None:
    """Run the live page alone.

    Example: tritrack animate configs/live.toml
    """
    from animator.__main__ import main as animator_main

    settings = config.load(settings_file)
    clip = two_camera_clip(settings)
    animator_main(settings, clip.rig, clip.every / clip.views[0].fps)


@app.command()
def track(
    clips: Annotated[list[Path], typer.Argument(help="Clip folders, or settings files.")],
    out: Out = Path("runs"),
    mode: ModeName = "default",
    views: Annotated[
        Literal["12", "1", "2"], typer.Option(help="Both cameras, or only one of them.")
    ] = "12",
    size: Annotated[str, typer.Option(help="Bound of the working picture.")] = "160x120",
    json_wanted: JsonWanted = False,
) -> None:
    """Track clips offline: the same as live, deterministic, as fast as it goes.

    Example: tritrack track clips/*/ --mode paper --out runs
    """
    from tritrack.offline import track_all

    facts = track_all(clips, out, mode, VIEWERS[views], size, console)
    tell(facts, json_wanted, f"{len(facts['clips'])} clips tracked, written to {out}")


@app.command()
def synth(
    out: Out,
    motion: Annotated[
        Literal["postures", "free"], typer.Option(help="The 15 postures, or free motion.")
    ] = "postures",
    performers: Annotated[int, typer.Option(min=1, max=1000)] = 1,
    takes: Annotated[int, typer.Option(min=1, max=100)] = 1,
    seed: Annotated[int, typer.Option(min=0, help="The first performer's.")] = 0,
    size: Annotated[str, typer.Option(help="Of the pictures.")] = "320x240",
    posture: Annotated[
        list[str] | None, typer.Option(help="Only this posture; may be given again.")
    ] = None,
) -> None:
    """Make clips of made-up people whose truth is known.

    Example: tritrack synth --out clips --performers 3 --seed 7
    """
    from tritrack.making import make_clips

    made = make_clips(out, motion, performers, takes, seed, size, tuple(posture or ()), console)
    console.print(f"{len(made)} clips written to {out}")


@app.command()
def train(
    runs: Annotated[
        list[Path], typer.Argument(help="Run folders (track) of clips that name their posture.")
    ],
    out: Annotated[Path, typer.Option(help="The model file to write.")],
    mode: ModeName = "default",
    json_wanted: JsonWanted = False,
) -> None:
    """Learn postures from clips or runs: one hidden Markov model each.

    Example: tritrack train clips/*/ --out postures.npz
    """
    from tritrack.training import train_postures

    facts = train_postures(runs, out, mode, console)
    tell(facts, json_wanted, f"{len(facts['sequences'])} postures learnt, written to {out}")


@app.command()
def doctor(json_wanted: JsonWanted = False) -> None:
    """Check the installation and name what is missing.

    Example: tritrack doctor
    """
    from tritrack.doctor import examine, table_of

    findings = examine()
    if json_wanted:
        print(json.dumps([finding._asdict() for finding in findings], indent=1))
    else:
        console.print(table_of(findings))
    if any(not finding.ok and finding.needed for finding in findings):
        raise typer.Exit(1)


@app.command()
def bench(
    quick: Annotated[bool, typer.Option(help="Fewer repetitions.")] = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Measure this machine: matches, search, tracking, memory.

    Example: tritrack bench
    """
    from tritrack.bench import main as bench_main

    bench_main(json_wanted, quick)


@calibrate_app.command()
def markers(
    measured: Annotated[Path, typer.Argument(help="Points on the line markers (TOML).")],
) -> None:
    """Say how far each camera is turned, tilted and rolled away from the marked lines.

    Example: tritrack calibrate markers configs/markers.toml
    """
    from integrator.calibration import run_markers

    for aim in run_markers(measured):
        console.print(str(aim))


@calibrate_app.command()
def poles(
    measured: Annotated[Path, typer.Argument(help="Tops of the poles in both pictures (TOML).")],
    out: Annotated[Path, typer.Option(help="The file to write.")] = Path("calibration.json"),
) -> None:
    """Find focal lengths and distances from poles at known places, with error bars.

    Example: tritrack calibrate poles configs/poles.toml --out clips/calibration.json
    """
    from integrator.calibration import run_poles

    quality = run_poles(measured, out)
    for camera in quality.cameras:
        console.print(str(camera))
    console.print(f"written to {out}")


def two_camera_clip(settings: Settings) -> Any:
    """The clip that settings name, with a camera for each viewer where it is calibrated."""
    import msgspec

    from common.clips import open_clip
    from tritrack.offline import both_cameras

    clip = open_clip(settings)
    return msgspec.structs.replace(clip, rig=both_cameras(clip))


def with_mode(settings: Settings, mode: Literal["default", "paper"] | None) -> Settings:
    """The settings, in a mode that the command line names."""
    import msgspec

    return settings if mode is None else msgspec.structs.replace(settings, mode=mode)


def tell(facts: dict[str, Any], json_wanted: bool, line: str) -> None:
    """A command's result: JSON on stdout, or a line for a person."""
    if json_wanted:
        print(json.dumps(facts, indent=1))
    else:
        console.print(line)


def main() -> None:
    """Run a command; a user's mistake is one line and exit code 2, never a traceback.

    What is raised by a class of ours is meant for the user; all else is a fault of the program.
    """
    try:
        app()
    except Exception as error:
        if type(error).__module__.split(".")[0] not in OURS or logging.root.level <= logging.DEBUG:
            raise
        console.print(f"error: {error}", style="red", markup=False, soft_wrap=True)
        sys.exit(2)


if __name__ == "__main__":
    main()
