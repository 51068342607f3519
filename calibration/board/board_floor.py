"""The floor, from a board laid down on it, and the world that begins there."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from calibration.board.lens_start import Place, undone
from common.body.body import Vector
from common.rig.rig_file import CalibrationError

UPRIGHT: Final = 0.75
"""How much of a lying board's up is up for the cameras, at least, or to a side of all that are
rolled alike."""
BELOW_M: Final = 0.05
"""No board was ever this far below the floor."""
ABOVE_M: Final = 0.1
"""Cameras stand at least this far above it."""
FLAT_M: Final = 0.02
"""Boards whose corners are all as near to the floor of the last one lie on it too."""

STEEP: Final = 0.1
"""Sine of the angle to the vertical at which a camera looks straight down."""


class Floor(NamedTuple):
    """A floor in the first camera's axes."""

    up: Vector
    """(3,)"""
    origin: Vector
    """(3,) metres, on it: the middle of the board that lay there last."""
    rests: tuple[int, ...]
    """In which the board lay on it."""


def floor_of(
    boards: Sequence[Place], cameras: Sequence[Place], places: Vector, named: int | None
) -> Floor:
    """The floor by the boards that lie on it.

    Args:
        boards: Where the board was at each rest, in the first camera's axes.
        cameras: The first camera's axes in each one's own.
        places: (n, 3) of its corners.
        named: The rest in which it lay on the floor; None: the last below which no board ever was.

    Raises:
        CalibrationError: When it never lay there.
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

    Where it looks straight down z is where its picture has down.
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
    """Whether a board may lie on the floor: it faces up, all cameras are above it, no board below.

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
    """The normal that is near to a direction, and the height along it, of points (n, 3)."""
    middle = points.mean(axis=0)
    normal: Vector = np.linalg.svd(points - middle, full_matrices=False)[2][2]
    normal = normal * np.sign(normal @ near)
    return normal, float(middle @ normal)
