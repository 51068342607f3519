"""Arguments and options that several commands share."""

from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Final, Literal

import typer

from common.atomic_file import refuse_special
from common.bus.messages import MOST_VIEWS, ViewerNumber
from common.config.part_settings import MOST_OFFSET_S, SettingsError
from common.config.picture_size import size_of

MODES: Final = "default: most accurate; paper: as published 2004"
WORKED_ON: Final = "Largest working picture, WIDTHxHEIGHT."
Checked = Callable[[float | None], float | None]
"""A callback that accepts or refuses an option."""


def writable(folder: Path | None) -> Path | None:
    """A folder that can be written or created; another one is refused before long work begins.

    Raises:
        BadParameter: When it is neither. A folder is created there for a test, because permissions
            alone do not tell, as in /proc.
    """
    if folder is None:
        return None
    place = next(one for one in (folder, *folder.absolute().parents) if one.exists())
    if not place.is_dir():
        raise typer.BadParameter(f"cannot write {folder}: Not a directory: {place}")
    try:
        with TemporaryDirectory(dir=place, prefix=".tritrack-"):
            pass
    except OSError as error:
        raise typer.BadParameter(f"cannot write {folder}: {error.strerror}: {place}") from error
    return folder


def size_given(text: str | None) -> str | None:
    """A picture size, checked before anything is opened.

    Raises:
        BadParameter: When it is invalid.
    """
    try:
        if text is not None:
            size_of(text)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error
    return text


def numbers_given(text: str) -> tuple[ViewerNumber, ...]:
    """Numbers of cameras: 2, 1,3 or, as earlier versions wrote them, 12; in ascending order.

    Raises:
        BadParameter: When one is invalid, too large, or repeated.
    """
    words = [word.strip() for word in text.split(",")] if "," in text else [*text]
    if not words or not all(word.isascii() and word.isdigit() for word in words):
        raise typer.BadParameter(f"cameras are numbers with commas between: 2 or 1,3; got {text}")
    numbers = sorted(int(word) for word in words)
    if numbers[0] < 1 or numbers[-1] > MOST_VIEWS:
        raise typer.BadParameter(f"cameras have the numbers 1 to {MOST_VIEWS}, got {text}")
    if len(set(numbers)) < len(numbers):
        raise typer.BadParameter(f"each camera is named once, got {text}")
    return tuple(numbers)


def views_given(text: str | None) -> str | None:
    """The cameras to use, checked before anything is opened.

    Raises:
        BadParameter: As `numbers_given`.
    """
    if text is not None:
        numbers_given(text)
    return text


def measured(unit: str, low: float, high: float, hundredths: bool = False) -> Checked:
    """A callback that refuses a number out of bounds, with its unit.

    Args:
        unit: Unit of the number.
        low: Smallest value; `high`: largest.
        high: Largest value.
        hundredths: Ask whether a hundredth was meant, as where the user gives centimetres.
    """

    def check(value: float | None) -> float | None:
        if value is None or low <= value <= high:
            return value
        meant = f": {value / 100:g}?" if hundredths and low <= value / 100 <= high else ""
        raise typer.BadParameter(f"from {low:g} to {high:g} {unit}, got {value:g}{meant}")

    return check


stature_given = measured("metres", 0.5, 2.6, hundredths=True)
fov_given = measured("degrees", 10.0, 150.0)
offset_given = measured("seconds", -MOST_OFFSET_S, MOST_OFFSET_S)
square_given = measured("mm", 1.0, 1000.0)


def writable_file(path: Path | None) -> Path | None:
    """A file that can be written or replaced.

    Raises:
        BadParameter: When it is a folder, or its folder cannot be written.
        FileRefused: When it is no ordinary file.
    """
    if path is None:
        return None
    if path.is_dir():
        raise typer.BadParameter(f"{path} is a folder: name a file")
    refuse_special(path)
    writable(path.parent)
    return path


Out = Annotated[Path, typer.Option(help="Folder to write into.", callback=writable)]
ModeName = Annotated[
    Literal["default", "paper"] | None, typer.Option(help=f"{MODES}. Else the settings' mode.")
]
OwnMode = Annotated[
    Literal["default", "paper"] | None,
    typer.Option(help="How clips are tracked, if not in the recogniser's own mode."),
]
CACHE: Final = Path("runs/.tracked")
"""Default folder of cached results, hidden so that `runs/*/` matches runs alone."""
Cache = Annotated[
    Path,
    typer.Option(
        help="Keeps what tracking made of clips, 56 kB each; may be deleted.", callback=writable
    ),
]
Record = Annotated[
    bool,
    typer.Option(help="Keep silhouettes and joints as recording.mcap: tritrack replay, Foxglove."),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on with what was cut short; leave out what is done.")
]
Force = Annotated[
    bool, typer.Option("--force", help="Write over a run of another clip or command.")
]
Offset = Annotated[
    float | None,
    typer.Option(
        help="Seconds by which camera 2 is late: above 0 where it shows later what camera 1 shows; "
        "below 0 where it was started later.",
        callback=offset_given,
    ),
]
NoBackground = Annotated[
    Literal["none"] | None,
    typer.Option(help="none: people are seen by the landmark network alone."),
]
People = Annotated[
    Literal["1", "all"] | None,
    typer.Option(
        help="1: one person is followed; all: everyone, each with a number. Else the settings'."
    ),
]
Forced = Annotated[bool, typer.Option("--force", help="Replace a file that is there.")]
LandmarkSource = Annotated[
    str | None,
    typer.Option(
        help="What finds joints in the pictures: own, none, mediapipe, FILE.onnx, or a folder of "
        "keypoints. Else the settings' landmarks."
    ),
]
Views = Annotated[
    str | None,
    typer.Option(help="Cameras to use, as 2 or 1,3; else all.", callback=views_given),
]
Size = Annotated[
    str | None,
    typer.Option(help=f"{WORKED_ON} Else the settings' size.", callback=size_given),
]


def refuse_given(options: Mapping[str, object], because: str) -> None:
    """Refuse the first option that has a value.

    Args:
        options: Values by name; None or False where it was not given.
        because: What the line says after the option's name.

    Raises:
        SettingsError: Where one has.
    """
    given = [name for name, value in options.items() if value is not None and value is not False]
    if given:
        raise SettingsError(f"{given[0]} {because}")
