"""The front door: every command of tritrack."""

import errno
import logging
import os
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import msgspec
import typer

from common import config
from common.config import Settings
from common.messages import ViewerNumber
from tritrack.answers import JsonWanted, console, results, tell
from tritrack.calibrate import calibrate_app
from tritrack.terminal import complain, json_text

OURS = ("animator", "common", "integrator", "recognizer", "synth", "tritrack", "viewer")

STOPPED = 130
"""Exit code of what Ctrl-C ended before it was done, as shells count it."""

FULL = (errno.ENOSPC, errno.EDQUOT)
"""What a full disk says, wherever it is met."""

VIEWERS: dict[str, tuple[ViewerNumber, ...]] = {"12": (1, 2), "1": (1,), "2": (2,)}

app = typer.Typer(
    name="tritrack",
    help="Body tracking and posture recognition from two ordinary cameras, in real time.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(calibrate_app, name="calibrate")

log = logging.getLogger(__name__)

ConfigPath = Annotated[Path, typer.Argument(help="A settings file (TOML), or a clip folder.")]
Out = Annotated[Path, typer.Option(help="Folder to write into.")]
ModeName = Annotated[
    Literal["default", "paper"] | None, typer.Option(help="Instead of the settings' mode.")
]
OwnMode = Annotated[
    Literal["default", "paper"] | None,
    typer.Option(help="How clips are tracked, if not in the recogniser's own mode."),
]
CACHE = Path("runs/tracked")
Cache = Annotated[
    Path, typer.Option(help="Keeps what tracking made of clips, 56 kB each; may be deleted.")
]
RecognizerName = Annotated[
    Literal["default", "paper"], typer.Option(help="The better models, or the paper's.")
]
Size = Annotated[
    str | None, typer.Option(help="Bound of the working picture, instead of the settings'.")
]


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
    page: Annotated[bool, typer.Option(help="Show it on the live page too.")] = True,
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
    mode: ModeName = None,
    size: Size = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Track live: on recorded clips at their own pace, or on cameras. Ctrl-C ends it.

    Example: tritrack live configs/live.toml --out runs/monday
    """
    from tritrack.offline import overridden
    from tritrack.session import live as run_live

    settings = overridden(config.load(settings_file), mode, size)
    name = settings_file.stem if settings_file.is_file() else ""
    facts = run_live(settings, out, console, name)
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
    viewer_main(live_settings(settings_file), number)


@app.command()
def integrate(settings_file: ConfigPath) -> None:
    """Run the integrator alone: the others connect to it.

    Example: tritrack integrate configs/live.toml
    """
    from integrator.__main__ import main as integrator_main
    from tritrack.offline import measured_before

    settings = live_settings(settings_file)
    clip = two_camera_clip(settings)
    integrator_main(settings, msgspec.structs.replace(clip, body=measured_before(settings)))


@app.command()
def recognize(settings_file: ConfigPath) -> None:
    """Run the recognizer alone.

    Example: tritrack recognize configs/live.toml
    """
    from recognizer.__main__ import main as recognizer_main

    settings = live_settings(settings_file)
    clip = two_camera_clip(settings)
    recognizer_main(settings, clip.every / clip.views[0].fps)


@app.command()
def animate(settings_file: ConfigPath) -> None:
    """Run the live page alone.

    Example: tritrack animate configs/live.toml
    """
    from animator.__main__ import main as animator_main

    settings = live_settings(settings_file)
    clip = two_camera_clip(settings)
    animator_main(settings, clip.rig, clip.every / clip.views[0].fps)


@app.command()
def track(
    clips: Annotated[list[Path], typer.Argument(help="Clip folders, or settings files.")],
    out: Out = Path("runs"),
    mode: Annotated[
        Literal["default", "paper", "thesis"] | None,
        typer.Option(help="Instead of the settings' mode; the thesis's is for one view."),
    ] = None,
    views: Annotated[
        Literal["12", "1", "2"], typer.Option(help="Both cameras, or only one of them.")
    ] = "12",
    size: Size = None,
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
        Literal["postures", "free", "stream"],
        typer.Option(help="The 15 postures, free motion, or all of them in one take."),
    ] = "postures",
    performers: Annotated[int, typer.Option(min=1, max=1000, help="How many people.")] = 1,
    takes: Annotated[int, typer.Option(min=1, max=100, help="Of each posture by each person.")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="The first performer's.")] = 0,
    size: Annotated[str, typer.Option(help="Of the pictures.")] = "320x240",
    posture: Annotated[
        list[str] | None, typer.Option(help="Only this posture; may be given again.")
    ] = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Make clips of made-up people whose truth is known.

    Example: tritrack synth --out clips --performers 3 --seed 7
    """
    from tritrack.making import make_clips

    made = make_clips(out, motion, performers, takes, seed, size, tuple(posture or ()), console)
    facts = {"clips": [str(folder) for folder in made]}
    tell(facts, json_wanted, f"{len(made)} clips written to {out}")


@app.command()
def train(
    out: Annotated[Path, typer.Option(help="The model file to write.")],
    runs: Annotated[
        list[Path] | None,
        typer.Argument(help="Clips that name their posture, or their run folders."),
    ] = None,
    what: Annotated[
        Literal["postures", "proposals"],
        typer.Option(help="What is learnt; proposals of poses need no clips."),
    ] = "postures",
    recognizer: RecognizerName = "default",
    mode: OwnMode = None,
    add_to: Annotated[
        Path | None,
        typer.Option(help="A file, or shipped: it learns the postures too, or learns them anew."),
    ] = None,
    cache: Cache = CACHE,
    json_wanted: JsonWanted = False,
) -> None:
    """Learn postures from clips or runs, or how outlines show poses from made-up people.

    A new posture needs three takes; with --add-to, the shipped model or another learns it too.

    Example: tritrack train clips/*/ --out postures.npz --add-to shipped
    """
    if what == "proposals":
        from tritrack.proposals import train_proposals

        facts = train_proposals(out, 0, console)
        tell(facts, json_wanted, f"{facts['instants']} instants learnt, written to {out}")
        return
    if not runs:
        raise typer.BadParameter("name clips or run folders to learn postures from")
    from tritrack.training import train_postures

    facts = train_postures(runs, out, mode, console, recognizer, cache, add_to)
    line = (
        f"{len(facts['sequences'])} postures learnt, {len(facts['knows'])} known; written to {out}"
    )
    tell(facts, json_wanted, line)


evaluate_app = typer.Typer(help="Measure how well people are tracked, and recognised.")
app.add_typer(evaluate_app, name="evaluate")


@evaluate_app.command("postures")
def evaluate_postures(
    clips: Annotated[
        list[Path], typer.Argument(help="Clips that name their posture, or their run folders.")
    ],
    out: Out,
    split: Annotated[
        str, typer.Option(help="Or whom to learn from and test on: r01,r04:r07, s1*:s2*")
    ] = "leave-one-performer-out",
    recognizer: Annotated[
        Literal["both", "default", "paper"], typer.Option(help="Which models, side by side.")
    ] = "both",
    mode: OwnMode = None,
    model: Annotated[
        Path | None, typer.Option(help="A file, or shipped: it names all clips, nothing is learnt.")
    ] = None,
    sweep: Annotated[
        bool, typer.Option(help="The paper's with 16 to 256 symbols and 3 to 8 states too.")
    ] = False,
    cache: Cache = CACHE,
    dask: Annotated[
        str, typer.Option(help="Address of a Dask scheduler to work on instead, tcp://host:8786.")
    ] = "",
    json_wanted: JsonWanted = False,
) -> None:
    """Name the postures of people whom the models never saw: the paper's table 2.

    Clips are tracked by all cores, about 450 MB each; what was tracked is kept, so that a run
    that was stopped goes on where it was.

    Example: tritrack evaluate postures clips/*/ --split 's1*:s2*' --out report
    """
    from tritrack import evaluating

    plan = evaluating.Plan(split, evaluating.KINDS[recognizer], mode, model, sweep, cache, dask)
    report = evaluating.evaluate_postures(clips, out, plan, console)
    tables = [
        f"{name} recogniser:\n{result['table']}" for name, result in report["recognizers"].items()
    ]
    tell(report, json_wanted, "\n\n".join(tables))


@evaluate_app.command("spotting")
def evaluate_spotting(
    runs: Annotated[
        list[Path],
        typer.Argument(help="Streams, or clips of one posture each, or their run folders."),
    ],
    out: Out,
    model: Annotated[
        Path | None, typer.Option(help="A model file, instead of the one in the package.")
    ] = None,
    mode: ModeName = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Find performances in streams that nobody cuts: how many, how soon, how many that are none.

    Example: tritrack evaluate spotting runs/*_stream --out report
    """
    from tritrack import spotting_report

    report = spotting_report.evaluate_spotting(runs, out, model, mode, console)
    tell(report, json_wanted, report["table"])


@evaluate_app.command("tracking")
def evaluate_tracking(
    clips: Annotated[list[Path], typer.Argument(help="Clips with a truth, or their run folders.")],
    out: Out,
    runs: Annotated[
        Path | None, typer.Option(help="Where runs stand; clips without one are tracked into it.")
    ] = None,
    mode: ModeName = None,
    size: Size = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Track clips and hold joints, silhouettes, lengths and confidence against their truth.

    Example: tritrack evaluate tracking clips/*/ --out report
    """
    from tritrack import accuracy_report, against_truth

    report = against_truth.evaluate_tracking(clips, out, runs, mode, size, console)
    facts = accuracy_report.headline(report)
    tell(facts, json_wanted, f"{accuracy_report.line(report)}; written to {out}")


@app.command()
def single(
    videos: Annotated[
        list[Path],
        typer.Argument(help="Videos of one camera that stands still, or FILE.npz#MASKS."),
    ],
    out: Out = Path("runs"),
    notes: Annotated[
        Path | None, typer.Option(help="Your inputs, instead of notes.toml beside the video.")
    ] = None,
    mode: Annotated[
        Literal["default", "thesis"], typer.Option(help="The best known, or as printed.")
    ] = "default",
    size: Annotated[str, typer.Option(help="Bound of the working picture.")] = "320x240",
    json_wanted: JsonWanted = False,
) -> None:
    """Animate a body from any video of one camera: no calibration, no empty room is needed.

    Example: tritrack single dance.mp4 --out runs
    """
    from tritrack.offline import overridden
    from tritrack.single import single_all

    facts = single_all(videos, out, notes, overridden(Settings(), mode, size), console)
    tell(facts, json_wanted, f"{len(facts['clips'])} videos followed, written to {out}")


@app.command()
def export(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    to: Annotated[Literal["bvh", "csv"], typer.Option(help="For Blender, or for spreadsheets.")],
    out: Annotated[
        Path | None,
        typer.Option(help="The file to write; body.bvh or poses.csv in RUN by default."),
    ] = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Write a run as a file for other programs.

    Example: tritrack export runs/walk --to bvh
    """
    from tritrack.exporting import export_run

    facts = export_run(run, to, out)
    tell(facts, json_wanted, f"{facts['frames']} frames written to {facts['file']}")


@app.command()
def retouch(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    video: Annotated[Path | None, typer.Option(help="The run's video, where it has moved.")] = None,
    notes: Annotated[
        Path | None, typer.Option(help="Instead of notes.toml beside the video.")
    ] = None,
    port: Annotated[int, typer.Option(min=1, max=65535, help="Of the page.")] = 8080,
    json_wanted: JsonWanted = False,
) -> None:
    """Look at a run frame by frame, and say what its video does not show. Ctrl-C ends it.

    Example: tritrack retouch runs/dance
    """
    from tritrack.ledger import line_of
    from tritrack.retouching import retouch as run_page

    facts = run_page(run, video, notes, port, console)
    tell(facts, json_wanted, line_of(facts))


@app.command()
def doctor(json_wanted: JsonWanted = False) -> None:
    """Check the installation and name what is missing.

    Example: tritrack doctor
    """
    from tritrack.doctor import examine, table_of

    findings = examine()
    if json_wanted:
        print(json_text([finding._asdict() for finding in findings]))
    else:
        results.print(table_of(findings))
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


def live_settings(path: Path) -> Settings:
    """The settings of a process of a live run."""
    from tritrack.session import refuse_mode

    settings = config.load(path)
    refuse_mode(settings)
    return settings


def two_camera_clip(settings: Settings) -> Any:
    """The clip that settings name, with a camera for each viewer where it is calibrated."""
    from common.clips import open_clip
    from tritrack.offline import both_cameras

    clip = open_clip(settings)
    return msgspec.structs.replace(clip, rig=both_cameras(clip))


def main() -> None:
    """Run a command; a user's mistake is one line and exit code 2, never a traceback.

    What is raised by a class of ours is meant for the user; all else is a fault of the program.
    """
    try:
        code = app(standalone_mode=False)
    except typer.TyperException as error:
        code = refuse_usage(error)
    except (typer.Abort, KeyboardInterrupt):
        code = STOPPED
    except Exception as error:
        full = isinstance(error, OSError) and error.errno in FULL
        if not full and type(error).__module__.split(".")[0] not in OURS:
            raise
        log.debug("refused", exc_info=error)
        complain(console, str(error))
        code = 2
    if code == STOPPED:
        complain(console, "stopped before it was done")
    sys.exit(code or 0)


def refuse_usage(error: typer.TyperException) -> int:
    """Say in one line what is wrong with a command line; a command without its words gets help."""
    text = error.format_message()
    if text.startswith("Usage:"):
        print(text, file=sys.stderr)
        return 2
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "tritrack"
    text = text.replace("Value error, ", "").rstrip(".")
    complain(console, f"{text}; see: {command} --help")
    return 2


if __name__ == "__main__":
    main()
