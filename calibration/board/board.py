"""The calibration board: a ChArUco pattern of our own, or a chessboard."""

import re
from functools import lru_cache
from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.rig_file import CalibrationError

Paper = Literal["a4", "a3"]
SHEETS_MM: Final[dict[Paper, tuple[float, float]]] = {"a4": (297.0, 210.0), "a3": (420.0, 297.0)}
"""Width and height of the sheet, landscape."""
MARKER_SHARE: Final = 0.75
"""Side of a marker over that of a square."""
BITS: Final = 6
"""Number of cells along a marker's side, its black border included."""
DICTIONARY: Final = cv2.aruco.DICT_4X4_50
LEAST_SQUARES: Final = 3
MOST_SQUARES: Final = 30


class Board(NamedTuple):
    """A flat pattern of squares. Its inner corners are numbered in rows, from the top left."""

    columns: int
    """Number of squares across."""
    rows: int
    square_m: float
    first_marker: int | None
    """Number of its first marker; None for a chessboard, which has none."""


BOARDS: Final[dict[Paper, Board]] = {
    "a4": Board(5, 4, 0.048, 0),
    "a3": Board(5, 4, 0.070, 10),
}
"""The boards to print; each has markers of its own, so that a video shows which one it is."""


def chessboard(squares: str, square_m: float) -> Board:
    """A chessboard by its count of squares, such as 9x6.

    Raises:
        CalibrationError: When it is no count, or belongs to a board that looks the same upside
        down.
    """
    told = re.fullmatch(r"(\d+)x(\d+)", squares)
    if not told:
        raise CalibrationError(f"{squares!r} is no count of squares: say 9x6, columns x rows")
    columns, rows = int(told[1]), int(told[2])
    if not LEAST_SQUARES < min(columns, rows) <= max(columns, rows) <= MOST_SQUARES:
        raise CalibrationError(
            f"a chessboard of {squares} squares: {LEAST_SQUARES + 1} to {MOST_SQUARES} each way "
            "are needed; all squares are counted, not the corners between them"
        )
    if (columns + rows) % 2 == 0:
        raise CalibrationError(
            f"a chessboard of {squares} squares looks the same turned about: cover a row of it, or "
            "print ours (--print)"
        )
    return Board(columns, rows, square_m, None)


def corner_places(board: Board) -> Vector:
    """(n, 3) metres: x to the right, y down the print, z into it; the origin is its top left."""
    across, down = np.meshgrid(np.arange(1, board.columns), np.arange(1, board.rows))
    places = np.column_stack([across.ravel(), down.ravel(), np.zeros(across.size)])
    return np.asarray(places * board.square_m, np.float64)


@lru_cache(maxsize=4)
def charuco(board: Board) -> cv2.aruco.CharucoBoard:
    """OpenCV's board, with squares of one unit."""
    first = board.first_marker or 0
    markers = np.arange(first, first + board.columns * board.rows // 2)
    dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
    return cv2.aruco.CharucoBoard(
        (board.columns, board.rows), 1.0, MARKER_SHARE, dictionary, markers
    )


def black_cells(board: Board) -> list[tuple[float, float, float, float]]:
    """The black areas as rectangles (left, top, width, height) in squares, from the top left."""
    cells = []
    for row in range(board.rows):
        for column in range(board.columns):
            if (row + column) % 2 == 0:
                cells.append((float(column), float(row), 1.0, 1.0))
    if board.first_marker is not None:
        opencvs = charuco(board)
        for number, place in zip(np.ravel(opencvs.getIds()), opencvs.getObjPoints(), strict=True):
            left, top = np.asarray(place)[:, :2].min(axis=0).tolist()
            cells += _marker_cells(int(number), left, top)
    return cells


def _marker_cells(number: int, left: float, top: float) -> list[tuple[float, float, float, float]]:
    side = MARKER_SHARE / BITS
    dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
    bits: NDArray[np.uint8] = cv2.aruco.generateImageMarker(dictionary, number, BITS)
    return [
        (left + column * side, top + row * side, side, side)
        for row, column in np.argwhere(bits == 0).tolist()
    ]
