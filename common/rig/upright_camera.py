"""Cameras made upright by quarter turns, with square pixels; and the mapping of picture places."""

from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Camera, as_matrix, as_row
from common.rig.rig_file import CalibrationError
from common.rig.upright import Size, Upright

CLOCKWISE: Final = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""A quarter turn of a camera's axes that turns its picture clockwise."""
SQUARE: Final = 0.01
"""Relative difference of a pixel's sides below which pixels count as square."""
TILTED_SENSOR: Final = 12
"""Index from which on OpenCV's distortion coefficients tilt the sensor, first about x: no
quarter turn keeps that order."""


def upright_of(camera: Camera, size: Size) -> Upright | None:
    """The change that makes a camera's picture upright and its pixels square; None where it is so
    already.

    Args:
        camera: Calibrated for pictures of this size.
        size: Size of the file's picture at the working size.
    """
    quarters, square = quarters_of(camera), size
    aspect = camera.K[1][1] / camera.K[0][0]
    if abs(aspect - 1.0) > SQUARE:
        shrink = max(1.0, aspect)
        square = (max(1, round(size[0] * aspect / shrink)), max(1, round(size[1] / shrink)))
    if not quarters and square == size:
        return None
    return Upright(*size, quarters, *square)


def quarters_of(camera: Camera) -> int:
    """The clockwise quarter turns after which the world's y points up most nearly, 0 to 3."""
    right, down = np.array(camera.R)[:2, 1]
    return int(np.argmax(np.round([-down, -right, down, right], 9)))


def upright_camera(camera: Camera, upright: Upright | None) -> Camera:
    """The camera of the working picture.

    Args:
        camera: The camera of the file's picture at the working size.
        upright: The change of the picture.

    Raises:
        CalibrationError: When its distortion cannot be turned.
    """
    if upright is None:
        return camera
    square = (upright.square_width, upright.square_height)
    return _turned(_scaled(camera, _shrinks(upright)), square, upright.quarters)


def filed_camera(camera: Camera, upright: Upright | None) -> Camera:
    """The inverse of `upright_camera`."""
    if upright is None:
        return camera
    return _scaled(_turned(camera, upright.size, -upright.quarters % 4), 1.0 / _shrinks(upright))


def _scaled(camera: Camera, times: Vector) -> Camera:
    K = np.diag([*times, 1.0]) @ np.array(camera.K)
    return msgspec.structs.replace(camera, K=as_matrix(K))


def _turned(camera: Camera, size: Size, quarters: int) -> Camera:
    """The camera of a picture of this size after quarter turns clockwise."""
    (beside, height), K = size, np.array(camera.K)
    R, t = np.array(camera.R), np.array(camera.t)
    for _ in range(quarters):
        K = np.array([[K[1, 1], 0.0, height - K[1, 2]], [0.0, K[0, 0], K[0, 2]], [0.0, 0.0, 1.0]])
        R, t, height, beside = CLOCKWISE @ R, CLOCKWISE @ t, beside, height
    bent = _turned_distortion(camera, quarters)
    return Camera(camera.name, as_matrix(K), as_matrix(R), as_row(t), bent)


def _turned_distortion(camera: Camera, quarters: int) -> tuple[float, ...]:
    """Coefficients that bend towards an axis go to the axis that this one becomes."""
    bent = list(camera.distortion)
    if quarters and any(bent[TILTED_SENSOR:]):
        raise CalibrationError(
            f"camera {camera.name} is rolled by more than 45 degrees, and its distortion tilts the "
            "sensor (14 numbers): turn its video upright, and calibrate it without that"
        )
    for _ in range(quarters):
        if len(bent) >= 4:
            bent[2], bent[3] = bent[3], -bent[2]
        if len(bent) >= TILTED_SENSOR:
            bent[8:12] = -bent[10], -bent[11], bent[8], bent[9]
    return tuple(bent)


def as_filed(pixels: NDArray[np.float64], upright: Upright | None) -> NDArray[np.float64]:
    """Places (n, 2) of the working picture, in the file's picture at the working size."""
    if upright is None:
        return pixels
    (width, height), at = upright.size, pixels
    for _ in range(upright.quarters):
        at = np.stack([at[:, 1], width - at[:, 0]], axis=1)
        width, height = height, width
    return np.asarray(at / _shrinks(upright))


def as_worked_on(pixels: NDArray[np.float64], upright: Upright | None) -> NDArray[np.float64]:
    """The inverse of `as_filed`."""
    if upright is None:
        return pixels
    at = pixels * _shrinks(upright)
    beside, height = upright.square_width, upright.square_height
    for _ in range(upright.quarters):
        at = np.stack([height - at[:, 1], at[:, 0]], axis=1)
        height, beside = beside, height
    return at


def _shrinks(upright: Upright) -> Vector:
    """Scale factors that make pixels square, across and down."""
    return np.array([upright.square_width, upright.square_height]) / [upright.width, upright.height]
