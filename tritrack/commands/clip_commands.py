"""The commands for recorded clips: make, track, follow and retouch them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from common.config.part_settings import BusSettings
from common.config.settings import Settings
from runtime.faults import refuse_unfollowed
from runtime.terminal import counted, json_text
from tritrack.commands.command_output import JsonWanted, console, tell
from tritrack.commands.options import (
    MODES,
    WORKED_ON,
    Force,
    LandmarkSource,
    NoBackground,
    Offset,
    Out,
    People,
    Record,
    Resume,
    Size,
    Views,
    numbers_given,
    refuse_given,
    size_given,
    writable,
)
from tritrack.commands.report_commands import line_of_reports


def track(
    clips: Annotated[list[Path], typer.Argument(help="Clip folders, or settings files.")],
    out: Out = Path("runs"),
    mode: Annotated[
        Literal["default", "paper", "thesis"] | None,
        typer.Option(
            help=f"{MODES}; thesis: as published 2006, one camera. Else the settings' mode."
        ),
    ] = None,
    views: Views = None,
    size: Size = None,
    landmarks: LandmarkSource = None,
    people: People = None,
    trust_calibration: Annotated[
        bool, typer.Option("--trust-calibration", help="Go on with a calibration that seems wrong.")
    ] = False,
    offset: Offset = None,
    background: NoBackground = None,
    record: Record = False,
    report: Annotated[
        bool, typer.Option(help="Write report.html, a video of all views, plots: tritrack report.")
    ] = False,
    resume: Resume = False,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Track recorded clips, as fast as possible.

    The same clip gives the same poses, byte for byte.

    A run that is stopped, by Ctrl-C or a crash, resumes with the same command and --resume, and
    gives the same poses as without a stop.

    Ends with exit code 3 where a clip's body is followed in less than half of its frames with a
    person, no person is found, or a video could not be read to its end.

    Example: tritrack track clips/*/ --mode paper --out runs
    """
    from runtime.offline.batch import Asked, track_all

    seen = mode, size, landmarks, None if views is None else numbers_given(views), trust_calibration
    asked = Asked(*seen, record, resume, force, offset, background, people)
    facts = track_all(clips, out, asked, console)
    lines = [line_of_runs(facts["clips"], out)]
    if report:
        from tritrack.reporting.reporting import report_all

        made = report_all([out / name for name in facts["clips"]], console)["reports"]
        lines.append(line_of_reports([*made.values()]))
    tell(facts, json_wanted, "\n".join(lines))
    refuse_unfollowed(facts["clips"])


def line_of_runs(clips: Mapping[str, Mapping[str, Any]], out: Path) -> str:
    """Number of tracked clips, and the share of frames in which the body is believed."""
    shares = [facts["believed"] for facts in clips.values() if facts["believed"] is not None]
    doubted = [name for name, facts in clips.items() if (facts.get("trust") or {}).get("advice")]
    rig = f"; not believable: the calibration of {', '.join(doubted)}, see the warning above"
    line = f"{counted(len(clips), 'clip')} tracked, written to {out}"
    if shares:
        line += f"; believed in {sum(shares) / len(shares):.0%} of the frames with a person"
    return line + (rig if doubted else "")


Motion = Annotated[
    Literal["postures", "free", "fall", "stream", "spot", "cross"] | None,
    typer.Option(
        help="15 postures, free, falls, postures in one take, always on one spot, a second "
        "person walks past one on a spot."
    ),
]
Performers = Annotated[
    int | None, typer.Option(min=1, max=1000, help="How many people, one in each clip.")
]
SceneOf = Annotated[
    int | None, typer.Option(help="Scenes instead: so many people in a room at once, 1 to 5.")
]
Seconds = Annotated[float | None, typer.Option(help="How long a scene of --people is.")]
Begins = Annotated[bool, typer.Option(help="A scene begins with an empty room.")]
Alone = Annotated[bool, typer.Option("--alone", help="Each of a scene alone, too.")]
Takes = Annotated[int, typer.Option(min=1, max=100, help="Takes of each, or scenes.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the first performer.")]
Rendered = Annotated[str, typer.Option(help="Picture size, WIDTHxHEIGHT.", callback=size_given)]
Performed = Annotated[
    list[str] | None,
    typer.Option(help="Only this posture; may be given again. With --people, one for each."),
]
CameraCount = Annotated[
    int, typer.Option(help="How many, 1 to 8: the paper's two, then more around the person.")
]
Moving = Annotated[bool | None, typer.Option("--moving", help="Screens and trees move.")]


def synth(
    out: Out,
    motion: Motion = None,
    performers: Performers = None,
    people: SceneOf = None,
    seconds: Seconds = None,
    opening: Begins = True,
    alone: Alone = False,
    takes: Takes = 1,
    seed: Seed = 0,
    size: Rendered = "320x240",
    posture: Performed = None,
    cameras: CameraCount = 2,
    moving: Moving = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Make clips of synthetic people with ground truth.

    With --people there are several in each: they walk past and around each other, perform
    different postures, embrace, hand things over, come in and leave.

    Example: tritrack synth --out scenes --people 2 --cameras 3 --takes 4 --seed 7
    """
    from synth.scene.scene_clips import SCENE_S, SceneSet
    from synth.write import ClipSet
    from tritrack.making import make_clips

    of_scenes = {"--seconds": seconds, "--alone": alone, "--no-opening": not opening}
    of_one = {"--motion": motion, "--performers": performers, "--moving": moving}
    refuse_mixed(people is not None, of_scenes, of_one)
    only = tuple(posture or ())
    wanted: ClipSet | SceneSet
    if people is None:
        some = (motion or "postures", performers or 1, takes, seed, only, cameras)
        wanted = ClipSet(*some, moving=bool(moving))
    else:
        lasts_s = SCENE_S if seconds is None else seconds
        wanted = SceneSet(people, lasts_s, takes, seed, cameras, opening, alone, only)
    made = make_clips(out, wanted, size, console)
    facts = {"clips": [str(folder) for folder in made]}
    tell(facts, json_wanted, f"{counted(len(made), 'clip')} written to {out}")


def refuse_mixed(
    are_scenes: bool, of_scenes: Mapping[str, object], of_one: Mapping[str, object]
) -> None:
    """Refuse what was given for clips of another kind: scenes, or clips of one person."""
    if are_scenes:
        refuse_given(of_one, because="is of clips of one person: leave it or --people out")
    else:
        refuse_given(of_scenes, because="needs --people: other clips have their own")


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
        Literal["default", "thesis"],
        typer.Option(help="default: most accurate; thesis: as published 2006."),
    ] = "default",
    size: Annotated[str, typer.Option(help=WORKED_ON, callback=size_given)] = "320x240",
    landmarks: LandmarkSource = None,
    background: Annotated[
        Path | None,
        typer.Option(help="A picture of the scene without a person, or none: work without."),
    ] = None,
    resume: Resume = False,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Animate a body from any video of one camera.

    The camera stands still; no calibration and no empty room is needed.

    A run that is stopped resumes with the same command and --resume.

    Ends with exit code 3 where a video's body is followed in less than half of its frames with a
    person, no person is found, or a video could not be read to its end.

    Example: tritrack single dance.mp4 --out runs
    """
    from runtime.overrides import overridden
    from tritrack.single.single import Given, single_all

    given = Given(notes, background, resume, force, landmarks)
    facts = single_all(videos, out, given, overridden(Settings(), mode, size), console)
    if json_wanted:
        print(json_text(facts))
    refuse_unfollowed(facts["clips"])


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
    page: Annotated[
        bool, typer.Option("--page", help="Play it on a page of this machine, until Ctrl-C.")
    ] = False,
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the page.")] = 8080,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Replay a recorded run: integrate, play or publish it.

    Example: tritrack replay runs/walk
    """
    from tritrack.replaying import replay_on_bus, replay_run

    if bus:
        facts = replay_on_bus(run, BusSettings(endpoint=bus, keys=keys), speed, console)
        tell(facts, json_wanted, f"{counted(facts['said'], 'message')} said")
        return
    if page:
        from tritrack.replay_page import replay_on_page

        facts = replay_on_page(run, port, console)
        tell(facts, json_wanted, f"{facts['shown']} frames shown")
        return
    facts = replay_run(run, out, force)
    bodies = counted(facts["bodies"], "body", "bodies")
    line = f"{bodies}, {facts['same']} of them the same byte for byte"
    line += "" if out is None else f"; written to {out}"
    tell(facts, json_wanted, line)


def retouch(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    video: Annotated[Path | None, typer.Option(help="The run's video, where it has moved.")] = None,
    notes: Annotated[
        Path | None, typer.Option(help="Instead of notes.toml beside the video.")
    ] = None,
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the page.")] = 8080,
    json_wanted: JsonWanted = False,
) -> None:
    """Correct a run frame by frame, on a page. Ctrl-C ends it.

    Enter there what the video does not show; "Fit again" fits the video with these inputs.

    Example: tritrack retouch runs/dance
    """
    from tritrack.single.ledger import line_of
    from tritrack.single.retouching import retouch as run_page

    facts = run_page(run, video, notes, port, console)
    tell(facts, json_wanted, line_of(facts))
