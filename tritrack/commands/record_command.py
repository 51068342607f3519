"""The command that records cameras into a clip."""

from pathlib import Path
from typing import Annotated, Any

import typer

from runtime.terminal import bar, say
from tritrack.commands.command_output import JsonWanted, console, tell
from tritrack.commands.options import Force, writable


def record(
    out: Annotated[Path, typer.Option(help="The clip's folder.", callback=writable)],
    camera: Annotated[
        list[str] | None,
        typer.Option(
            help="A device number, or a video that plays as a camera; once for each camera, in "
            "order. Else the first two of this machine."
        ),
    ] = None,
    seconds: Annotated[
        float, typer.Option(min=1.0, max=1200.0, help="How long; Ctrl-C ends it before.")
    ] = 60.0,
    force: Force = False,
    json_wanted: JsonWanted = False,
) -> None:
    """Record two to eight cameras into a clip folder.

    Each frame keeps the time it was taken, in meta.json; frames that are missing are counted, and
    it is said by how much a camera shows the same motion later than the first.

    Example: tritrack record --out clips/walk --camera 0 --camera 2 --seconds 30
    """
    from common.video.clip_sources import ClipError
    from runtime.live.session import stopped_by_signals
    from tritrack.machine_cameras.camera_list import cameras_of, no_camera
    from tritrack.recording_cameras.record_clip import record_clip

    given = camera or [str(found.source) for found in cameras_of(())[:2]]
    if not given:
        raise ClipError(no_camera("tritrack record"))
    sources = [int(each) if each.isdecimal() else each for each in given]
    with stopped_by_signals(console) as stop, bar(console) as progress:
        task = progress.add_task("recording", total=1.0)
        facts = record_clip(
            sources,
            out,
            seconds,
            stop,
            lambda text: say(console, text),
            force,
            lambda share: progress.update(task, completed=share),
        )
    tell(facts, json_wanted, "\n".join(lines_of(facts)))


def lines_of(facts: dict[str, Any]) -> list[str]:
    """What came of it, a line a camera."""
    lines = [f"{facts['folder']}: {facts['seconds']:.1f} s, {facts['why']}"]
    for name, each in facts["cameras"].items():
        line = f"{name} ({each['source']}): {each['frames']} frames, {each['fps']:.2f} a second"
        line += f", {each['dropped']} missing" if each["dropped"] else ""
        if name in facts["later_s"]:
            late_s = facts["later_s"][name]
            line += (
                "; how late it is, its motion does not say"
                if late_s is None
                else f"; it shows motion {late_s:+.3f} s after cam1"
            )
        lines.append(line)
    return lines
