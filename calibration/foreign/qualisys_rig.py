"""Calibrations of Qualisys: the text that its track manager exports (.qca.txt)."""

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Final

import numpy as np

from calibration.foreign.foreign_camera import ForeignCamera
from common.rig.rig_file import CalibrationError

UNIT: Final = 64.0
"""Units per pixel of the focal lengths and centres."""
MM: Final = 1000.0
TO_OPENCV: Final = np.diag([1.0, -1.0, -1.0])
"""Rotation from Qualisys's camera axes (y up, looking along -z) to OpenCV's."""
LARGEST: Final = 10_000_000


def read_qualisys(path: Path) -> list[ForeignCamera]:
    """All cameras of a file, in its order.

    Raises:
        CalibrationError: When it cannot be read or lacks a part.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise CalibrationError(f"{path} is too large for a calibration")
        root = ET.fromstring(path.read_bytes())
        return [_camera(camera) for camera in root.iter("camera")]
    except OSError as error:
        raise CalibrationError(f"cannot read the calibration {path}: {error.strerror}") from error
    except (ET.ParseError, KeyError) as error:
        raise CalibrationError(f"{path} is no calibration of Qualisys: {error}") from error


def _camera(camera: ET.Element) -> ForeignCamera:
    view, lens = _numbers(camera, "fov_video"), _numbers(camera, "intrinsic")
    place = _numbers(camera, "transform")
    size = (
        round(view["right"] - view["left"] + 1),
        round(view["bottom"] - view["top"] + 1),
    )
    K = np.eye(3)
    K[0, 0], K[1, 1] = lens["focalLengthU"] / UNIT, lens["focalLengthV"] / UNIT
    K[0, 2] = lens["centerPointU"] / UNIT - view["left"]
    K[1, 2] = lens["centerPointV"] / UNIT - view["top"]
    turn = np.array([[place[f"r{i}{j}"] for j in (1, 2, 3)] for i in (1, 2, 3)])
    R = TO_OPENCV @ turn
    centre_m = np.array([place[axis] for axis in "xyz"]) / MM
    names = ("radialDistortion1", "radialDistortion2", "tangentalDistortion1")
    distortion = tuple(lens[name] for name in (*names, "tangentalDistortion2"))
    return ForeignCamera(camera.attrib["serial"], size, K, R, -R @ centre_m, distortion)


def _numbers(camera: ET.Element, name: str) -> dict[str, float]:
    part = camera.find(name)
    if part is None:
        raise KeyError(f"a camera without {name}")
    return {key: float(value) for key, value in part.attrib.items()}
