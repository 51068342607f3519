"""Calibrations in anipose's TOML form: anipose's own, Pose2Sim's, Caliscope's."""

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal

import cv2
import numpy as np

from calibration.foreign.foreign_camera import ForeignCamera, with_z_up
from common.config.toml_fault import toml_fault
from common.npz_file import Facts
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError

TomlKind = Literal["pose2sim", "caliscope"]
NEEDED: Final = ("matrix", "rotation", "translation", "size")


def read_toml(path: Path) -> list[ForeignCamera]:
    """All cameras of a file, in its order.

    Raises:
        CalibrationError: When it cannot be read, or one of its cameras is a fisheye or lacks a
        part.
    """
    try:
        content = tomllib.loads(path.read_text())
        return [_camera(name, table, path) for name, table in _tables(content)]
    except OSError as error:
        raise CalibrationError(f"cannot read the calibration {path}: {error.strerror}") from error
    except (ValueError, TypeError, cv2.error) as error:
        if isinstance(error, CalibrationError):
            raise
        raise CalibrationError(
            f"{path} is no calibration in TOML: {toml_fault(str(error))}"
        ) from error


def _tables(content: Facts) -> Iterator[tuple[str, Facts]]:
    """The tables of cameras, at any depth."""
    for name, table in content.items():
        if isinstance(table, dict) and "matrix" in table:
            yield name, table
        elif isinstance(table, dict):
            yield from _tables(table)


def _camera(section: str, table: Facts, path: Path) -> ForeignCamera:
    missing = [key for key in NEEDED if key not in table]
    if missing:
        raise CalibrationError(f"{path}: [{section}] has no {missing[0]}: calibrate it there first")
    if table.get("fisheye"):
        raise CalibrationError(f"{path}: [{section}] is a fisheye, which is not supported")
    turn = np.array(table["rotation"], float)
    R = turn if turn.shape == (3, 3) else cv2.Rodrigues(turn.reshape(3))[0]
    if not np.isfinite(np.array(table["size"], float)).all():
        raise CalibrationError(f"{path}: size of [{section}] is no size: {table['size']}")
    width, height = (round(side) for side in table["size"])
    return ForeignCamera(
        str(table.get("name", section)),
        (width, height),
        np.array(table["matrix"], float).reshape(3, 3),
        np.asarray(R, float),
        np.array(table["translation"], float).reshape(3),
        tuple(float(number) for number in np.ravel(table.get("distortions", ()))),
        _quarters(section, table, path),
    )


def _quarters(section: str, table: Facts, path: Path) -> int:
    """Clockwise quarter turns with which Caliscope shows a picture; its other numbers are for
    the picture before the turn."""
    count = table.get("rotation_count", 0)
    if not isinstance(count, int):
        raise CalibrationError(f"{path}: rotation_count of [{section}] is no whole number: {count}")
    return count % 4


def toml_text(rig: Rig, kind: TomlKind) -> str:
    """A rig in this form, its world with z up."""
    parts = [_table(n, camera, kind) for n, camera in enumerate(with_z_up(rig))]
    if kind == "pose2sim":
        parts.append("[metadata]\nadjusted = false\nerror = 0.0\n")
    return "\n".join(parts)


def _table(number: int, camera: ForeignCamera, kind: TomlKind) -> str:
    turn = cv2.Rodrigues(camera.R)[0].ravel().tolist()
    distortion = list(camera.distortion[:5]) or [0.0] * 5
    lines = {
        "size": list(camera.size_px),
        "matrix": camera.K.tolist(),
        "rotation": turn,
        "translation": camera.t.tolist(),
    }
    if kind == "pose2sim":
        section = camera.name
        lines |= {"name": camera.name, "distortions": distortion[:4], "fisheye": False}
    else:
        section = f"cam_{number}"
        lines |= {"port": number, "distortions": distortion, "ignore": False}
        lines["rotation_count"] = camera.quarters
    told = "\n".join(f"{key} = {json.dumps(value)}" for key, value in lines.items())
    return f"[{json.dumps(section)}]\n{told}\n"
