"""The floor from a board that lies on it, and the world's origin there."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from calibration.board.lens_start import Place, undone
from common.body.body import Vector
from common.rig.rig_file import CalibrationError

UPRIGHT: Final = 0.75
"""Smallest component of a lying board's normal along the cameras' up axis, or along one side
axis where all cameras are rolled alike."""
BELOW_M: Final = 0.05
"""Largest depth of a board below the floor, metres."""
ABOVE_M: Final = 0.1
"""Smallest height of a camera above the floor, metres."""
FLAT_M: Final = 0.02
"""Boards whose corners are all this near to the last one's floor, metres, lie on it too."""

STEEP: Final = 0.1
"""Sine of the angle to the vertical below which a camera looks straight down."""


class Floor(NamedTuple):
    """A floor in the first camera's axes."""

    up: Vector
    """(3,)"""
    origin: Vector
    """(3,) metres, on the floor: the middle of the board at the last rest on it."""
    rests: tuple[int, ...]
    """The rests at which the board lay on it."""


def floor_of(
    boards: Sequence[Place], cameras: Sequence[Place], places: Vector, named: int | None
) -> Floor:
    """The floor from the boards that lie on it.

    Args:
        boards: The board's place at each rest, in the first camera's axes.
        cameras: From the first camera's axes to each camera's.
        places: (n, 3) the board's corners, metres.
        named: The rest at which it lay on the floor; None: the last one with no board below it.

    Raises:
        CalibrationError: When the board never lay on the floor.
    """
    corners = np.stack([_moved(board, places) for board in boards])
    if named is None:
        lying = [n for n in range(len(boards)) if _lies(n, boards, corners, cameras)]
        if not lying:
            raise CalibrationError(
                "the board never lies on the floor: lay it down for two seconds at the end, before "
                "the cameras, or say when it lies there: --floor SECONDS"
            )
        named = lying[-1]
    up, height_m = _plane(corners[named], _up_of(boards[named]))
    flat = [n for n, one in enumerate(corners) if np.abs(one @ up - height_m).max() < FLAT_M]
    up, height_m = _plane(corners[flat].reshape(-1, 3), up)
    middle = corners[named].mean(axis=0)
    return Floor(up, middle + (height_m - middle @ up) * up, tuple(flat))


def world_cameras(cameras: Sequence[Place], floor: Floor) -> list[tuple[Vector, Vector]]:
    """R and t of each camera in a world with x to the right in camera 1, y up, z towards it.

    Where camera 1 looks straight down, z points down in its picture.
    """
    towards = np.array([0.0, 0.0, -1.0])
    if np.linalg.norm(np.cross(towards, floor.up)) < STEEP:
        towards = np.array([0.0, 1.0, 0.0])
    z = towards - (towards @ floor.up) * floor.up
    z /= np.linalg.norm(z)
    axes = np.stack([np.cross(floor.up, z), floor.up, z])
    told = []
    for camera in cameras:
        R = cv2.Rodrigues(camera.turn)[0]
        told.append((R @ axes.T, R @ floor.origin + camera.shift))
    return told


def _lies(rest: int, boards: Sequence[Place], corners: Vector, cameras: Sequence[Place]) -> bool:
    """Whether a board can lie on the floor: it faces up, all cameras are above it, no board is
    below.

    A board that is held at a slant has others below its plane.
    """
    up, at = _up_of(boards[rest]), corners[rest].mean(axis=0)
    across_down = np.mean([cv2.Rodrigues(camera.turn)[0][:2] for camera in cameras], axis=0)
    if np.abs(across_down @ up).max() < UPRIGHT:
        return False
    heights = [(undone(camera).shift - at) @ up for camera in cameras]
    return min(heights) > ABOVE_M and float(((corners - at) @ up).min()) > -BELOW_M


def _up_of(board: Place) -> Vector:
    up: Vector = -cv2.Rodrigues(board.turn)[0][:, 2]
    return up


def _moved(board: Place, places: Vector) -> Vector:
    turned: Vector = places @ cv2.Rodrigues(board.turn)[0].T + board.shift
    return turned


def _plane(points: Vector, near: Vector) -> tuple[Vector, float]:
    """The plane's normal on the side of a given direction, and the heights along it of points
    (n, 3)."""
    middle = points.mean(axis=0)
    normal: Vector = np.linalg.svd(points - middle, full_matrices=False)[2][2]
    normal = normal * np.sign(normal @ near)
    return normal, float(middle @ normal)
