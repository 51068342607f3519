"""What several commands take: their shared arguments and options."""

import os
from pathlib import Path
from typing import Annotated, Final, Literal

import typer


def writable(folder: Path | None) -> Path | None:
    """A folder that can be written, or made: what cannot is refused before long work, not after.

    Raises:
        BadParameter: When it is neither.
    """
    if folder is None:
        return None
    place = next(one for one in (folder, *folder.absolute().parents) if one.exists())
    if not place.is_dir():
        raise typer.BadParameter(f"cannot write {folder}: Not a directory: {place}")
    if not os.access(place, os.W_OK | os.X_OK):
        raise typer.BadParameter(f"cannot write {folder}: Permission denied: {place}")
    return folder


def writable_file(path: Path | None) -> Path | None:
    """A file that can be written, or replaced.

    Raises:
        BadParameter: When it is a folder, or its own cannot be written.
    """
    if path is None:
        return None
    if path.is_dir():
        raise typer.BadParameter(f"{path} is a folder: name a file")
    writable(path.parent)
    return path


Out = Annotated[Path, typer.Option(help="Folder to write into.", callback=writable)]
ModeName = Annotated[
    Literal["default", "paper"] | None, typer.Option(help="Instead of the settings' mode.")
]
OwnMode = Annotated[
    Literal["default", "paper"] | None,
    typer.Option(help="How clips are tracked, if not in the recogniser's own mode."),
]
CACHE: Final = Path("runs/tracked")
Cache = Annotated[
    Path,
    typer.Option(
        help="Keeps what tracking made of clips, 56 kB each; may be deleted.", callback=writable
    ),
]
Record = Annotated[
    bool,
    typer.Option(help="Keep outlines and joints as recording.mcap: tritrack replay, Foxglove."),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on with what was cut short; leave out what is done.")
]
Force = Annotated[
    bool, typer.Option("--force", help="Write over a run of another clip or command.")
]
Size = Annotated[
    str | None, typer.Option(help="Bound of the working picture, instead of the settings'.")
]
