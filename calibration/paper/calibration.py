"""From files of measured points to `calibration.json` and its quality (section 4.1)."""

import json
from pathlib import Path
from typing import TypeVar

import msgspec

from calibration.paper.markers import Aim, Markers, line_markers
from calibration.paper.poles import Poles, Quality, poles, refuse_other_units
from common.atomic_file import refuse_to_replace, replacing
from common.config.explained import explained
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError

Content = TypeVar("Content", Markers, Poles)


def run_markers(path: Path) -> tuple[Aim, ...]:
    """The aim of each camera in a file of line markers.

    Raises:
        CalibrationError: When the file cannot be read or a marker is no line.
    """
    markers = read_points(path, Markers)
    return tuple(line_markers(view, (markers.width, markers.height)) for view in markers.cameras)


def run_poles(path: Path, out: Path, replace: bool = False) -> Quality:
    """Calibrate from a file of poles and write `calibration.json`.

    Args:
        path: The file of poles.
        out: The file to write; its folder is created where missing.
        replace: True: an existing file may be replaced, although its poles may have taken an
            afternoon.

    Raises:
        CalibrationError: When a file cannot be read or written, a length is in another unit, or the
            poles do not suffice.
        FileRefused: When an existing file would be replaced.
    """
    measured = read_points(path, Poles)
    refuse_other_units(measured)
    rig, quality = poles(measured)
    refuse_to_replace(out, replace)
    write_rig(out, rig, quality)
    return quality


def write_rig(path: Path, rig: Rig, quality: msgspec.Struct | None = None) -> None:
    """Write a rig as `calibration.json`, with its quality beside it; the folder is created where
    missing.

    Raises:
        CalibrationError: When the file cannot be written.
    """
    content = msgspec.to_builtins(rig)
    if quality is not None:
        content |= {"quality": msgspec.to_builtins(quality)}
    write_text(path, msgspec.json.format(msgspec.json.encode(content), indent=1).decode())


def write_text(path: Path, text: str) -> None:
    """Write a calibration's text; the folder is created where missing.

    Raises:
        CalibrationError: When the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as new:
            new.write_text(text)
    except OSError as error:
        raise CalibrationError(f"cannot write the calibration {path}: {error.strerror}") from error


def read_points(path: Path, kind: type[Content]) -> Content:
    """A file of measured points, TOML or JSON.

    Raises:
        CalibrationError: When it cannot be read, or holds impossible values.
    """
    decode = msgspec.json.decode if path.suffix == ".json" else msgspec.toml.decode
    try:
        content = decode(path.read_bytes(), type=kind)
        json.dumps(msgspec.to_builtins(content), allow_nan=False)  # TOML allows nan and inf
    except OSError as error:
        raise CalibrationError(f"cannot read the points {path}: {error.strerror}") from error
    except (msgspec.DecodeError, RecursionError) as error:
        raise CalibrationError(f"{path}: {explained(error, kind)}") from error
    except ValueError as error:
        raise CalibrationError(f"{path}: no text, or a number that is not finite") from error
    return content
