"""The board's corners in a picture, by their numbers."""

from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.board.board import Board, charuco
from calibration.board.corner_alignment import aligned
from common.body.body import Vector

WIDE_PX: Final = 2560
"""Width that pictures are enlarged to, pixels: markers of ten pixels become readable."""
BARE_PX: Final = 640
"""Width that pictures are reduced to for a chessboard, pixels: it has no markers, so a full
search takes long where there is no board."""
LARGEST: Final = 4
ROUGHLY: Final = 4
"""Fewest corners, not all in a line, that show roughly where a board is."""
LEAST: Final = 6
"""Fewest corners of a board that must be seen well."""

Grey = NDArray[np.uint8]


def corners_in(picture: Grey, board: Board) -> Vector | None:
    """The board's corners in a picture.

    Args:
        picture: (height, width) or (height, width, 3).
        board: The board to look for.

    Returns:
        (n, 2) pixels, the centre of the first pixel at (0, 0); NaN for a hidden corner. None where
        too few
        are seen.
    """
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) if picture.ndim == 3 else picture
    wide_px = WIDE_PX if board.first_marker is not None else BARE_PX
    scale = int(np.clip(round(wide_px / grey.shape[1]), 1, LARGEST))
    large = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
    found = _of_chessboard(large, board) if board.first_marker is None else _charuco(large, board)
    if not _tells(found, ROUGHLY):
        return None
    found = aligned(grey, board, (found + 0.5) / scale - 0.5)
    return found if _tells(found, LEAST) else None


def _tells(px: Vector, least: int) -> bool:
    seen = px[np.isfinite(px[:, 0])]
    if len(seen) < least:
        return False
    across = np.linalg.svd(seen - seen.mean(axis=0), compute_uv=False)
    return bool(across[1] > 0.05 * across[0])


def _charuco(picture: Grey, board: Board) -> Vector:
    px = np.full(((board.columns - 1) * (board.rows - 1), 2), np.nan)
    corners, numbers, _, _ = _detector(board).detectBoard(picture)
    if numbers is not None:
        px[np.ravel(numbers)] = np.reshape(corners, (-1, 2))
    return px


@lru_cache(maxsize=4)
def _detector(board: Board) -> cv2.aruco.CharucoDetector:
    # Markers that were not read are searched where the others predict them: on boards that look
    # small or slanted this finds three to four times as many corners.
    more = cv2.aruco.CharucoParameters()
    more.tryRefineMarkers = True
    return cv2.aruco.CharucoDetector(charuco(board), more)


def _of_chessboard(picture: Grey, board: Board) -> Vector:
    across, down = board.columns - 1, board.rows - 1
    found, corners = cv2.findChessboardCornersSB(
        picture, (across, down), flags=cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_NORMALIZE_IMAGE
    )
    if not found:
        return np.full((across * down, 2), np.nan)
    px = np.reshape(corners, (down, across, 2)).astype(np.float64)
    if np.linalg.det(np.stack([px[0, 1] - px[0, 0], px[1, 0] - px[0, 0]])) < 0:
        px = px[:, ::-1]
    if _begins_white(picture, px):
        px = px[::-1, ::-1]
    return px.reshape(-1, 2)


def _begins_white(picture: Grey, px: Vector) -> bool:
    """Whether the squares that should be black are lighter than the others."""
    centres = (px[:-1, :-1] + px[1:, 1:] + px[:-1, 1:] + px[1:, :-1]) / 4
    columns, rows = np.round(centres).astype(int).reshape(-1, 2).T
    height, width = picture.shape
    greys = picture[rows.clip(0, height - 1), columns.clip(0, width - 1)].astype(float)
    down, across = np.indices(centres.shape[:2])
    black = ((down + across) % 2 == 0).ravel()
    return bool(greys[black].mean() > greys[~black].mean())
