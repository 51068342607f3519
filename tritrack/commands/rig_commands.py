"""The calibrate commands: where the cameras are, from a person, a board, or markers (4.1)."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import typer

from common.atomic_file import refuse_to_replace
from runtime.terminal import counted
from tritrack.commands.command_output import JsonWanted, console, tell_rows
from tritrack.commands.options import Forced, fov_given, square_given, stature_given, writable_file
from tritrack.extras import refuse_without

if TYPE_CHECKING:
    from calibration.person.rig_quality import Quality
    from calibration.tracks.camera_clocks import Clocks
    from runtime.offline.rig_of_boards import Shown

calibrate_app = typer.Typer(
    help="Find where the cameras are: by person, board or poles.",
    no_args_is_help=True,
)


Written = Annotated[Path, typer.Option(help="The file to write.", callback=writable_file)]
OUT: Final = Path("calibration.json")
Page = Annotated[
    Path | None,
    typer.Option(help="Click the points on a page, in pictures of this clip, or these settings."),
]
Port = Annotated[
    int | None, typer.Option(min=1, max=65535, help="Port of the page, instead of the settings'.")
]


def line_of_clocks(count: int, quality: "Quality", clocks: "Clocks") -> str:
    """How nearly so many views agree, and how late they are."""
    late = ", ".join(
        f"{round(frames, 1) + 0.0:+.1f}" + ("" if clock.is_found else f" ({clock.state})")
        for frames, clock in zip(quality.late_frames, clocks, strict=True)
    )
    views = "both views" if count == 2 else f"{count} views"
    behind = "view 2 is" if count == 2 else f"views 2 to {count} are"
    return (
        f"{views} agree to {quality.gap_mm:.0f} mm in {counted(quality.moments, 'moment')}; "
        f"{behind} late by {late} frames"
    )


@calibrate_app.command()
def person(
    clips: Annotated[list[Path], typer.Argument(help="Clips of one rig, or settings files.")],
    stature: Annotated[
        float,
        typer.Option(help="Of the person: 0.5 to 2.6 metres.", callback=stature_given),
    ] = 1.75,
    fov: Annotated[
        float | None,
        typer.Option(help="How wide the cameras see: 10 to 150 degrees.", callback=fov_given),
    ] = None,
    out: Written = OUT,
    force: Forced = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Calibrate all cameras by a person who moves.

    Nothing is printed or measured.

    Example: tritrack calibrate person clips/*/ --stature 1.82 --out clips/calibration.json
    """
    from calibration.paper.calibration import write_rig
    from common.config import config_file
    from common.video.clip_sources import refuse_no_source
    from runtime.offline.rig_of_clips import Given, calibrated_by_clips

    for path in clips:
        refuse_no_source(config_file.load(path), path)
    refuse_to_replace(out, force)
    rig, quality, clocks, heard = calibrated_by_clips(clips, Given(stature, fov))
    write_rig(out, rig, quality)
    tell_rows(quality.cameras, json_wanted)
    console.print(
        line_of_clocks(len(rig.cameras), quality, clocks), highlight=False, soft_wrap=True
    )
    for word in heard:
        console.print(word, highlight=False, soft_wrap=True)
    if quality.unsure:
        console.print(
            f"not known well enough: {', '.join(quality.unsure)}: record a person who walks to "
            "and fro all over the room, for a minute or more",
            highlight=False,
            soft_wrap=True,
        )
    console.print(f"written to {out}", highlight=False, soft_wrap=True)


@calibrate_app.command()
def board(
    videos: Annotated[
        list[Path] | None, typer.Argument(help="A video of each camera, at full size.")
    ] = None,
    print_: Annotated[
        Path | None,
        typer.Option("--print", help="Write the board to print (PDF).", callback=writable_file),
    ] = None,
    paper: Annotated[Literal["a4", "a3"], typer.Option(help="Paper to print on.")] = "a3",
    square: Annotated[
        float | None, typer.Option(help="Side of a square as measured, mm.", callback=square_given)
    ] = None,
    chessboard: Annotated[
        str | None, typer.Option(help="A chessboard of so many squares instead, such as 9x6.")
    ] = None,
    floor: Annotated[
        float | None,
        typer.Option(min=0.0, help="When the board lies on the floor: second of the first video."),
    ] = None,
    out: Written = OUT,
    force: Forced = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Calibrate cameras by a printed board, or print it.

    Hold the board for two seconds each in some thirty poses: near each camera all over its picture,
    tilted; then where both see it; at the end lay it on the floor at two or three places.

    Example: tritrack calibrate board --print board.pdf --paper a3

    Example: tritrack calibrate board cam1.mp4 cam2.mp4 --out clips/calibration.json
    """
    from calibration.board.board_print import print_board
    from common.video.clip_sources import refuse_unreadable
    from runtime.offline.rig_of_boards import Shown

    if print_ is None and not videos:
        raise typer.BadParameter("name the video of each camera, or --print board.pdf")
    for video in videos or []:
        refuse_unreadable(video)
    if print_ is not None:
        refuse_without("report", "matplotlib")
        refuse_to_replace(print_, force, "--print")
        print_board(print_, paper)
        console.print(f"written to {print_}", highlight=False, soft_wrap=True)
    if videos:
        refuse_to_replace(out, force)
        _calibrate(videos, Shown(square, chessboard, floor), out, json_wanted)


def _calibrate(videos: list[Path], shown: "Shown", out: Path, json_wanted: bool) -> None:
    """Calibrate with videos of the board, and report the quality."""
    from runtime.offline.rig_of_boards import calibrate_by_videos

    quality, drawn = calibrate_by_videos(videos, shown, out, console)
    tell_rows(quality.cameras, json_wanted)
    console.print(
        f"corners miss by {quality.reprojection_px:.2f} px; "
        f"{counted(quality.shared_rests, 'pose')} seen by several cameras; "
        f"the board lies on the floor at {quality.floor_s:.1f} s\n"
        f"written to {out}, what the board covered of each picture to {drawn}",
        highlight=False,
        soft_wrap=True,
    )


@calibrate_app.command()
def markers(
    measured: Annotated[Path, typer.Argument(help="Points on the line markers (TOML).")],
    page: Page = None,
    port: Port = None,
    json_wanted: JsonWanted = False,
) -> None:
    """Measure how cameras are aimed, from marked lines.

    It prints yaw, pitch and roll of each.

    Example: tritrack calibrate markers configs/markers.toml

    Example: tritrack calibrate markers markers.toml --page clips/empty
    """
    from calibration.paper.calibration import run_markers

    if page is None:
        tell_rows(run_markers(measured), json_wanted)
        return
    refuse_without("page", "websockets")
    from tritrack.marking.marking import Asked, mark_markers

    result = mark_markers(Asked(page, _kept(measured), port), console)
    tell_rows(result.rows, json_wanted)


@calibrate_app.command()
def poles(
    measured: Annotated[Path, typer.Argument(help="Tops of the poles in both pictures (TOML).")],
    page: Page = None,
    port: Port = None,
    out: Written = OUT,
    force: Forced = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Calibrate cameras by poles at known places.

    Finds focal lengths and distances, with error bars.

    Example: tritrack calibrate poles configs/poles.toml --out clips/calibration.json

    Example: tritrack calibrate poles poles.toml --page clips/poles --out clips/calibration.json
    """
    from calibration.paper.calibration import run_poles

    if page is None:
        tell_rows(run_poles(measured, out, force).cameras, json_wanted)
        console.print(f"written to {out}", highlight=False, soft_wrap=True)
        return
    refuse_without("page", "websockets")
    from tritrack.marking.marking import Asked, mark_poles

    refuse_to_replace(out, force)
    result = mark_poles(Asked(page, _kept(measured), port), out, console)
    tell_rows(result.rows, json_wanted)
    told = "no calibration was saved" if result.saved is None else f"written to {out}"
    if result.saved not in (None, result.newest):
        told += ", without what was changed since then; to take that in: "
        told += f"tritrack calibrate poles {measured} --out {out} --force"
    console.print(told, highlight=False, soft_wrap=True)


def _kept(points: Path) -> Path:
    """The page's file of points, refused before any click where it cannot be written."""
    writable_file(points)
    return points


@calibrate_app.command("import")
def import_(
    theirs: Annotated[
        Path,
        typer.Argument(
            help="Pose2Sim, Caliscope or anipose TOML; Qualisys .qca.txt; OpenCV .yml, .xml."
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            help="The file to write: calibration.json in a clip's folder, or in the one above.",
            callback=writable_file,
        ),
    ],
    camera: Annotated[
        list[str] | None, typer.Option(help="Only this camera; give each, in their order.")
    ] = None,
    up: Annotated[
        Literal["x", "y", "z", "-x", "-y", "-z"] | None,
        typer.Option(help="Which axis of its world is up, where rolled cameras do not show it."),
    ] = None,
    force: Forced = False,
) -> None:
    """Take the calibration of another program.

    Clips in the folder of the written file use it, and so do clips in its subfolders.

    Example: tritrack calibrate import Calib.toml --camera cam01 --camera cam04
    --out clips/calibration.json
    """
    from calibration.foreign.imported_rig import imported_rig
    from calibration.paper.calibration import write_rig

    rig = imported_rig(theirs, tuple(camera or ()), up)
    refuse_to_replace(out, force)
    write_rig(out, rig)
    console.print(
        f"{counted(len(rig.cameras), 'camera')} written to {out}", highlight=False, soft_wrap=True
    )


@calibrate_app.command("export")
def export_(
    ours: Annotated[Path, typer.Argument(help="A calibration.json.")],
    to: Annotated[Literal["pose2sim", "caliscope"], typer.Option(help="The other program.")],
    out: Annotated[Path, typer.Option(help="The file to write.", callback=writable_file)] = Path(
        "Calib.toml"
    ),
    force: Forced = False,
) -> None:
    """Write a calibration for another program.

    Its world has z up.

    Example: tritrack calibrate export calibration.json --to pose2sim --out Calib.toml
    """
    from calibration.foreign.toml_rig import toml_text
    from calibration.paper.calibration import write_text
    from common.rig.rig_file import load_rig

    text = toml_text(load_rig(ours), to)
    refuse_to_replace(out, force)
    write_text(out, text)
    console.print(f"written to {out}", highlight=False, soft_wrap=True)
