"""The commands for recorded clips: make, track, follow, retouch and export them."""

from pathlib import Path
from typing import Annotated, Final, Literal

import typer

from common.bus.messages import ViewerNumber
from common.config import Settings
from tritrack.commands.command_output import JsonWanted, console, tell
from tritrack.commands.options import Out, Size, writable_file
from tritrack.exporting import OWN_NAMES, Format, export_run
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
    json_wanted: JsonWanted = False,
) -> None:
    """Track clips offline: the same as live, deterministic, as fast as it goes.

    Example: tritrack track clips/*/ --mode paper --out runs
    """
    from tritrack.offline.batch import track_all

    facts = track_all(clips, out, mode, VIEWERS[views], size, console)
    tell(facts, json_wanted, f"{len(facts['clips'])} clips tracked, written to {out}")


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
    json_wanted: JsonWanted = False,
) -> None:
    """Animate a body from any video of one camera: no calibration, no empty room is needed.

    Example: tritrack single dance.mp4 --out runs
    """
    from tritrack.overrides import overridden
    from tritrack.single.single import Given, single_all

    given = Given(notes, background)
    facts = single_all(videos, out, given, overridden(Settings(), mode, size), console)
    if json_wanted:
        print(json_text(facts))


def export(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    to: Annotated[Format, typer.Option(help="For Blender, or for spreadsheets.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"The file to write; {' or '.join(OWN_NAMES.values())} in RUN by default.",
            callback=writable_file,
        ),
    ] = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Write a run as a file for other programs.

    Example: tritrack export runs/walk --to bvh
    """
    facts = export_run(run, to, out)
    tell(facts, json_wanted, f"{facts['frames']} frames written to {facts['file']}")


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
