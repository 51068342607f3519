"""Calibrations of OpenCV's own samples: YAML, XML or JSON of its FileStorage."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np

from calibration.foreign.foreign_camera import ForeignCamera
from common.body.body import Vector
from common.npz_file import Facts
from common.rig.rig_file import CalibrationError

LARGEST: Final = 10_000_000
PLACES: Final = "extrinsics"
"""Stem of the name of the file that stereo_calib writes beside intrinsics.yml."""
MATRICES: Final = ("camera_matrix", "cameraMatrix", "K", "M")
BENT: Final = ("distortion_coefficients", "distCoeffs", "D")
SIZES: Final = (("image_width", "image_height"), ("width", "height"))


def read_opencv(path: Path) -> list[ForeignCamera]:
    """The cameras of a file: one (`camera_matrix`), or two (`M1`, `D1`, `M2`, `D2`, `R`, `T`).

    What stereo_calib writes into a second file is read from `extrinsics.*` beside it. The first
    camera's axes are the world: no floor is given.

    Raises:
        CalibrationError: When it cannot be read or lacks a part.
    """
    content = _nodes(path)
    beside = path.with_name(PLACES + path.suffix)
    if _matrix(content, _numbered(MATRICES, 2)) is not None and "R" not in content:
        if not beside.is_file():
            raise CalibrationError(
                f"{path} has no R and T, and there is no {beside.name} beside it"
            )
        content |= _nodes(beside)
    size_px = _size(content, path)
    first = _matrix(content, [*MATRICES, *_numbered(MATRICES, 1)])
    if first is None:
        raise CalibrationError(f"{path} has no camera_matrix, nor M1: it is no camera of OpenCV's")
    bent = _matrix(content, [*BENT, *_numbered(BENT, 1)])
    cameras = [_camera("cam1", size_px, first, bent, (np.eye(3), np.zeros(3)))]
    second = _matrix(content, _numbered(MATRICES, 2))
    if second is not None:
        turn, shift = _matrix(content, ["R"]), _matrix(content, ["T"])
        if turn is None or shift is None:
            raise CalibrationError(f"{path} has two cameras and no R and T")
        place = (turn if turn.shape == (3, 3) else cv2.Rodrigues(turn)[0], shift)
        bent = _matrix(content, _numbered(BENT, 2))
        cameras.append(_camera("cam2", size_px, second, bent, place))
    return cameras


def _numbered(names: Sequence[str], number: int) -> list[str]:
    return [f"{name}{mark}{number}" for name in names for mark in ("", "_")]


def _camera(
    name: str,
    size_px: tuple[int, int],
    K: Vector,
    bent: Vector | None,
    place: tuple[Vector, Vector],
) -> ForeignCamera:
    distortion = () if bent is None else tuple(float(number) for number in bent.ravel())
    return ForeignCamera(name, size_px, K.reshape(3, 3), place[0], place[1].reshape(3), distortion)


def _nodes(path: Path) -> Facts:
    """The top nodes of a file, by name."""
    try:
        if path.stat().st_size > LARGEST:
            raise CalibrationError(f"{path} is too large for a calibration")
        path.read_bytes()
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        root = storage.root()
        return {name: _value(root.getNode(name)) for name in root.keys()}  # noqa: SIM118
    except OSError as error:
        raise CalibrationError(f"cannot read the calibration {path}: {error.strerror}") from error
    except (cv2.error, SystemError, UnicodeDecodeError) as error:
        raise CalibrationError(f"{path} is no file of OpenCV's FileStorage") from error


def _value(node: cv2.FileNode) -> Any:
    if node.isInt() or node.isReal():
        return node.real()
    if node.isSeq():
        return [_value(node.at(n)) for n in range(node.size())]
    if node.isMap():
        return _array(node)
    return node.string() if node.isString() else None


def _array(node: cv2.FileNode) -> Vector | None:
    """A matrix (rows, cols); None for any other node.

    OpenCV's own reader writes beyond its memory where a matrix states a wrong size.
    """
    shape = [node.getNode(name) for name in ("rows", "cols")]
    data = _value(node.getNode("data"))
    if not all(size.isInt() for size in shape) or not isinstance(data, list):
        return None
    rows, columns = (round(size.real()) for size in shape)
    numbers = [number for number in data if isinstance(number, float)]
    if min(rows, columns) < 1 or len(numbers) != len(data) or len(data) != rows * columns:
        return None
    return np.array(numbers).reshape(rows, columns)


def _matrix(content: Facts, names: Sequence[str]) -> Vector | None:
    return next(
        (content[name] for name in names if isinstance(content.get(name), np.ndarray)), None
    )


def _size(content: Facts, path: Path) -> tuple[int, int]:
    said: list[Any] = [[content.get(across), content.get(down)] for across, down in SIZES]
    said += [content.get(name) for name in ("imageSize", "image_size", "size")]
    for size in said:
        if isinstance(size, list) and [type(length) for length in size] == [float, float]:
            width, height = size
            return round(width), round(height)
    raise CalibrationError(
        f"{path} does not say how large the pictures are: add the lines image_width: and "
        "image_height: to it"
    )
