"""The commands for recorded clips: make, track, follow, retouch and export them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import typer

from common.bus.messages import ViewerNumber
from common.config.part_settings import BusSettings
from common.config.settings import Settings
from tritrack.commands.command_output import JsonWanted, console, tell
from tritrack.commands.options import Force, Out, Record, Resume, Size, writable, writable_file
from tritrack.exporting import OWN_NAMES, Format, Scale, export_run
from tritrack.faults import refuse_unfollowed
from tritrack.terminal import json_text

VIEWERS: Final[dict[str, tuple[ViewerNumber, ...]]] = {"12": (1, 2), "1": (1,), "2": (2,)}


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
    trust_calibration: Annotated[
        bool, typer.Option("--trust-calibration", help="Go on with a calibration that seems wrong.")
    ] = False,
    record: Record = False,
    resume: Resume = False,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Track clips offline: the same as live, deterministic, as fast as it goes.

    What is stopped, by Ctrl-C or by a crash, goes on where it was with the same command and
    --resume, and gives the same poses as without a stop.

    Ends with exit code 3 where a clip's body is believed in less than half of its frames.

    Example: tritrack track clips/*/ --mode paper --out runs
    """
    from tritrack.offline.batch import track_all

    facts = track_all(
        clips,
        out,
        mode,
        VIEWERS[views],
        size,
        console,
        trusted=trust_calibration,
        record=record,
        resume=resume,
        force=force,
    )
    tell(facts, json_wanted, line_of_runs(facts["clips"], out))
    refuse_unfollowed(facts["clips"])


def line_of_runs(clips: Mapping[str, Mapping[str, Any]], out: Path) -> str:
    """How many clips were tracked, and in how many of their frames the body is believed."""
    shares = [facts["believed"] for facts in clips.values() if facts["believed"] is not None]
    sure = f"; believed in {sum(shares) / len(shares):.0%} of the frames with a person"
    return f"{len(clips)} clips tracked, written to {out}" + (sure if shares else "")


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
    """Make clips of synthetic people whose truth is known.

    Example: tritrack synth --out clips --performers 3 --seed 7
    """
    from synth.write import ClipSet
    from tritrack.making import make_clips

    wanted = ClipSet(motion, performers, takes, seed, tuple(posture or ()))
    made = make_clips(out, wanted, size, console)
    facts = {"clips": [str(folder) for folder in made]}
    tell(facts, json_wanted, f"{len(made)} clips written to {out}")


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
    background: Annotated[
        Path | None, typer.Option(help="A picture of the scene without anybody, if there is one.")
    ] = None,
    resume: Resume = False,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Animate a body from any video of one camera: no calibration, no empty room is needed.

    What is stopped goes on where it was with the same command and --resume.

    Ends with exit code 3 where a video's body is believed in less than half of its frames.

    Example: tritrack single dance.mp4 --out runs
    """
    from tritrack.overrides import overridden
    from tritrack.single.single import Given, single_all

    given = Given(notes, background, resume, force)
    facts = single_all(videos, out, given, overridden(Settings(), mode, size), console)
    if json_wanted:
        print(json_text(facts))
    refuse_unfollowed(facts["clips"])


def export(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    to: Annotated[Format, typer.Option(help="Animation, movement laboratory, spreadsheet.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"The file to write; by default in RUN: {', '.join(OWN_NAMES.values())}.",
            callback=writable_file,
        ),
    ] = None,
    scale: Annotated[Scale, typer.Option(help="Unit of a BVH file.")] = "m",
    json_wanted: JsonWanted = False,
) -> None:
    """Write a run as a file for other programs.

    Example: tritrack export runs/walk --to bvh
    """
    facts = export_run(run, to, out, scale)
    off = facts.get("off_mm")
    told = f"; fixed bones: {off['median']} mm off, 95 % within {off['p95']} mm" if off else ""
    tell(facts, json_wanted, f"{facts['frames']} frames written to {facts['file']}{told}")


def replay(
    run: Annotated[Path, typer.Argument(help="A run folder that was written with --record.")],
    out: Annotated[
        Path | None,
        typer.Option(help="Write what the reports give now as a run.", callback=writable),
    ] = None,
    bus: Annotated[
        str, typer.Option(help="Say it all again at this endpoint, tcp/127.0.0.1:7447.")
    ] = "",
    speed: Annotated[
        float, typer.Option(min=0.1, max=100.0, help="On the bus: 2 is twice as fast.")
    ] = 1.0,
    keys: Annotated[str, typer.Option(help="On the bus: folder of the integrator's keys.")] = "",
    json_wanted: JsonWanted = False,
) -> None:
    """Send a recorded run through the integrator again, or say it again on a bus.

    Example: tritrack replay runs/walk
    """
    from tritrack.replaying import replay_on_bus, replay_run

    if bus:
        facts = replay_on_bus(run, BusSettings(endpoint=bus, keys=keys), speed, console)
        tell(facts, json_wanted, f"{facts['said']} messages said")
        return
    facts = replay_run(run, out)
    line = f"{facts['bodies']} bodies, {facts['same']} of them the same byte for byte"
    tell(facts, json_wanted, line)


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
    from tritrack.single.ledger import line_of
    from tritrack.single.retouching import retouch as run_page

    facts = run_page(run, video, notes, port, console)
    tell(facts, json_wanted, line_of(facts))
