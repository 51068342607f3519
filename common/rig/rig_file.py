"""Calibrations: read from their file, checked, scaled to the size of pictures."""

import json
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from common.config.explained import explained
from common.rig.camera import Rig, as_matrix

DISTORTIONS: Final = (0, 4, 5, 8, 12, 14)
"""Possible lengths of OpenCV's distortion models."""

SAME_SHAPE: Final = 0.02
"""Largest difference of aspect ratios at which two sizes show the same picture."""


class CalibrationError(ValueError):
    """An invalid calibration: the text names the file, the fault and the cure."""


def load_rig(path: Path, wanted: tuple[str, ...] = ()) -> Rig:
    """Read and check a `calibration.json`.

    Args:
        path: The file.
        wanted: Names of the cameras to keep, in this order; all when empty.

    Raises:
        CalibrationError: When the file cannot be read, lacks a part, or contradicts itself.
    """
    content = b""
    try:
        content = path.read_bytes()
        rig = msgspec.json.decode(content, type=Rig)
    except OSError as error:
        raise CalibrationError(
            f"cannot read the calibration {path}: {error.strerror}; make one (tritrack calibrate "
            "person), or take it out of the settings"
        ) from error
    except (msgspec.DecodeError, RecursionError) as error:
        _refuse_what_is_not_finite(path)
        raise CalibrationError(
            f"{path} is no calibration: {explained(error, Rig, content)}"
        ) from error
    if wanted:
        by_name = {camera.name: camera for camera in rig.cameras}
        missing = [name for name in wanted if name not in by_name]
        if missing:
            raise CalibrationError(
                f"{path} has no camera {missing[0]!r}; it has {', '.join(by_name)}"
            )
        rig = msgspec.structs.replace(rig, cameras=tuple(by_name[name] for name in wanted))
    rig = _with_shared_distortion(rig)
    check_rig(rig, str(path))
    return rig


def _refuse_what_is_not_finite(path: Path) -> None:
    """JSON has no NaN and no Infinity, though Python and others write them."""
    try:
        rig = msgspec.convert(json.loads(path.read_bytes()), Rig)
    except (ValueError, RecursionError):
        return
    check_rig(rig, str(path))


def _with_shared_distortion(rig: Rig) -> Rig:
    cameras = tuple(
        msgspec.structs.replace(camera, distortion=camera.distortion or rig.distortion)
        for camera in rig.cameras
    )
    return msgspec.structs.replace(rig, cameras=cameras)


def check_rig(rig: Rig, where: str) -> None:
    """Refuse a rig that no cameras could form.

    Raises:
        CalibrationError: With the camera's name, the number and what was expected.
    """
    if rig.width <= 0 or rig.height <= 0:
        raise CalibrationError(f"{where}: picture size {rig.width}x{rig.height} is not positive")
    if not rig.cameras:
        raise CalibrationError(f"{where}: it names no camera")
    for camera in rig.cameras:
        K = np.array(camera.K)
        for field in ("K", "R", "t", "distortion"):
            if not np.isfinite(getattr(camera, field)).all():
                raise CalibrationError(
                    f"{where}: {field} of camera {camera.name} has a number that is not finite; "
                    "calibrate again"
                )
        rotation = np.array(camera.R)
        off = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
        if off > 1e-3 or np.linalg.det(rotation) < 0:
            raise CalibrationError(
                f"{where}: R of camera {camera.name} is no rotation (R R^T is {off:.3g} off the "
                f"identity, determinant {np.linalg.det(rotation):.3g}); calibrate again"
            )
        if K[0, 0] <= 0 or K[1, 1] <= 0:
            raise CalibrationError(f"{where}: camera {camera.name} has no positive focal length")
        if K[0, 1] or K[1, 0] or K[2].tolist() != [0.0, 0.0, 1.0]:
            raise CalibrationError(
                f"{where}: K of camera {camera.name} must be fx 0 cx, 0 fy cy, 0 0 1; "
                f"it is transposed or skewed: {camera.K}"
            )
        if len(camera.distortion) not in DISTORTIONS:
            raise CalibrationError(
                f"{where}: camera {camera.name} has {len(camera.distortion)} distortion numbers, "
                f"OpenCV's model has {', '.join(map(str, DISTORTIONS[1:]))}"
            )


def is_of_shape(one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether two picture sizes have one shape, but for rounding to pixels and a cut edge."""
    return abs(one[0] * other[1] / (other[0] * one[1]) - 1.0) <= SAME_SHAPE


def fitted(rig: Rig, size: tuple[int, int], where: str) -> Rig:
    """The rig for pictures of another size of the same shape: K scaled, the rest kept.

    Raises:
        CalibrationError: When the shapes differ by more than a pixel's rounding.
    """
    width, height = size
    scale_x, scale_y = width / rig.width, height / rig.height
    if not is_of_shape(size, (rig.width, rig.height)):
        raise CalibrationError(
            f"{where} is for {rig.width}x{rig.height} pictures, the clip has {width}x{height}: "
            "another camera or a cropped picture; calibrate for this one"
        )
    scale = np.diag([scale_x, scale_y, 1.0])
    cameras = tuple(
        msgspec.structs.replace(camera, K=as_matrix(scale @ np.array(camera.K)))
        for camera in rig.cameras
    )
    return msgspec.structs.replace(rig, width=width, height=height, cameras=cameras)
