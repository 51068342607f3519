"""Initial lenses and relative camera places, from a board's rests."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

Points = NDArray[np.float32]

FOCALS: Final = (0.7, 1.0, 1.5)
"""Focal lengths to start from, in picture widths: closed forms fail on small boards."""
FLAGS: Final = (
    cv2.CALIB_USE_INTRINSIC_GUESS
    | cv2.CALIB_FIX_PRINCIPAL_POINT
    | cv2.CALIB_FIX_ASPECT_RATIO
    | cv2.CALIB_FIX_K2
    | cv2.CALIB_FIX_K3
    | cv2.CALIB_ZERO_TANGENT_DIST
)


class Place(NamedTuple):
    """Pose of a board relative to a camera, or of a camera relative to another: x = R(turn) x +
    shift."""

    turn: Vector
    """(3,) Rodrigues vector."""
    shift: Vector
    """(3,) metres."""


class Lens(NamedTuple):
    """What one camera alone determines."""

    K: Vector
    k1: float
    miss_px: float
    """Root mean square of the reprojection errors, pixels."""
    boards: dict[int, Place]
    """The board's pose, by the number of its rest."""


def lens_of(places: Vector, px: Vector, size_px: tuple[int, int]) -> Lens:
    """One camera alone: focal length, k1 and the board's pose at each rest.

    Args:
        places: (n, 3) the board's corners, metres.
        px: (m, n, 2) the corners in the camera's picture, NaN where hidden.
        size_px: Width and height of the picture.
    """
    rests = [row for row in range(len(px)) if np.isfinite(px[row, :, 0]).any()]
    seen = [np.isfinite(px[row, :, 0]) for row in rests]
    corners = [places[some].astype(np.float32) for some in seen]
    shown = [px[row][some].astype(np.float32) for row, some in zip(rests, seen, strict=True)]
    guesses = [_calibrated(corners, shown, size_px, focal) for focal in FOCALS]
    miss_px, K, bent, turns, shifts = min(guesses, key=lambda guess: guess[0])
    boards = {
        row: Place(np.ravel(turn), np.ravel(shift))
        for row, turn, shift in zip(rests, turns, shifts, strict=True)
    }
    return Lens(K, float(np.ravel(bent)[0]), float(miss_px), boards)


def _calibrated(
    corners: Sequence[Points], shown: Sequence[Points], size_px: tuple[int, int], focal: float
) -> tuple[float, Vector, Vector, Sequence[Vector], Sequence[Vector]]:
    width, height = size_px
    focal_px = focal * width
    K = np.array(
        [[focal_px, 0.0, (width - 1) / 2], [0.0, focal_px, (height - 1) / 2], [0.0, 0.0, 1.0]]
    )
    found: tuple[float, Vector, Vector, Sequence[Vector], Sequence[Vector]] = cv2.calibrateCamera(
        corners, shown, size_px, K, np.zeros(5), flags=FLAGS
    )
    return found


def chained(first: Place, then: Place) -> Place:
    """The composition of both poses."""
    turn, shift = cv2.composeRT(first.turn, first.shift, then.turn, then.shift)[:2]
    return Place(np.ravel(turn), np.ravel(shift))


def undone(place: Place) -> Place:
    """The inverse pose."""
    turn = cv2.Rodrigues(place.turn)[0]
    return Place(-place.turn, -turn.T @ place.shift)


def between(first: Lens, other: Lens, places: Vector, px: Vector) -> tuple[Place, float]:
    """Pose of another camera relative to the first: from the rest that agrees best with the others.

    Args:
        first: The first camera.
        other: The other camera, to which `px` (m, n, 2) belongs.
        places: (n, 3) the board's corners, metres.
        px: The corners in the other camera's picture, NaN where hidden.

    Returns:
        The pose of the first in the other's axes, and its median reprojection error, pixels.
    """
    shared = sorted(first.boards.keys() & other.boards.keys())
    guesses = [chained(undone(first.boards[row]), other.boards[row]) for row in shared]
    misses = []
    for guess in guesses:
        off = [
            _miss_px(other, chained(first.boards[row], guess), places, px[row]) for row in shared
        ]
        misses.append(float(np.median(off)))
    best = int(np.argmin(misses))
    return guesses[best], misses[best]


def _miss_px(lens: Lens, board: Place, places: Vector, px: Vector) -> float:
    seen = np.isfinite(px[:, 0])
    bent = np.array([lens.k1, 0.0, 0.0, 0.0])
    shown = cv2.projectPoints(places[seen], board.turn, board.shift, lens.K, bent)[0][:, 0]
    return float(np.linalg.norm(shown - px[seen], axis=1).mean())
