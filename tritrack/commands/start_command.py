"""The command that opens the start page."""

from pathlib import Path
from typing import Annotated

import typer

from tritrack.commands.command_output import console
from tritrack.commands.options import writable
from tritrack.extras import refuse_without


def start(
    runs: Annotated[Path, typer.Option(help="Folder of the runs.", callback=writable)] = Path(
        "runs"
    ),
    camera: Annotated[
        list[Path] | None,
        typer.Option(help="A video that plays as a camera; may be given again."),
    ] = None,
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the page.")] = 8080,
    browser: Annotated[bool, typer.Option(help="Open a browser, where there is a screen.")] = True,
) -> None:
    """Open a page from which all else is started.

    Drop videos there, choose cameras, look at runs, export them. Ctrl-C ends it.

    Example: tritrack start --runs runs
    """
    refuse_without("page", "websockets")
    from common.video.clip_sources import refuse_unreadable
    from tritrack.starting.start import start as serve_start
    from tritrack.starting.start_desk import Given

    for video in camera or []:
        refuse_unreadable(video)
    serve_start(Given(runs, tuple(camera or ())), port, browser, console)
