"""Corners to a few hundredths of a pixel: the picture is aligned with the print around each
corner."""

from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.board.board import Board, black_cells
from common.body.body import Vector

CELL_PX: Final = 32
"""Pixels per square's side, where the picture is warped to face the board."""
REACH: Final = 0.5
"""Window around a corner, squares."""
BLUR_PX: Final = 0.7
"""Blur of a picture, its own pixels: the lens and the pixel itself."""
LIKE: Final = 0.8
"""Correlation of picture and print below which a corner counts as hidden."""
ROUNDS: Final = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 1e-4)


def aligned(grey: NDArray[np.uint8], board: Board, px: Vector) -> Vector:
    """Corners, including missed ones, at the places where the print fits the picture best.

    The corner detector is biased towards the markers beside a corner: on synthetic videos by 0.05
    to 0.5 px at squares of 20 px. The print contains the markers too: 0.005 to 0.02 px remain.

    Args:
        grey: (height, width)
        board: The board that is seen.
        px: (n, 2) its corners roughly, NaN where not found; at least six found.

    Returns:
        (n, 2), NaN where the picture does not show the print.
    """
    seen = np.isfinite(px[:, 0])
    across, down = np.meshgrid(np.arange(1, board.columns), np.arange(1, board.rows))
    cells = np.stack([across.ravel(), down.ravel()], axis=1).astype(np.float64)
    onto = cv2.findHomography(cells[seen], px[seen], cv2.RANSAC, 2.0)[0]
    if onto is None:
        return np.full(px.shape, np.nan)
    finer = np.array([[CELL_PX, 0.0, -0.5], [0.0, CELL_PX, -0.5], [0.0, 0.0, 1.0]])
    facing = finer @ np.linalg.inv(onto)
    size = (board.columns * CELL_PX, board.rows * CELL_PX)
    turned = cv2.warpPerspective(grey, facing, size, flags=cv2.INTER_CUBIC)
    found = np.full(px.shape, np.nan)
    spans = _spans_px(onto, cells)
    inside = _inside(onto, cells, grey.shape)
    for corner in np.flatnonzero(inside).tolist():
        at = _aligned(turned, board, cells[corner], spans[corner])
        if at is not None:
            found[corner] = cv2.perspectiveTransform(at.reshape(1, 1, 2), onto)[0, 0]
    return found


def _inside(onto: Vector, cells: Vector, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """(n,) whether a picture contains the whole window of a corner."""
    rim = np.array([(x, y) for x in (-REACH, REACH) for y in (-REACH, REACH)])
    around = (cells[:, None] + rim).reshape(-1, 1, 2)
    px = cv2.perspectiveTransform(around, onto).reshape(len(cells), -1)
    low, high = px.min(axis=1), (np.array([shape[1], shape[0]] * 4) - 1 - px).min(axis=1)
    return np.asarray((low > 0) & (high > 0))


def _spans_px(onto: Vector, cells: Vector) -> Vector:
    """(n, 2) pixels per square along its sides, at each corner."""
    here, right, below = (
        cv2.perspectiveTransform((cells + step).reshape(-1, 1, 2), onto)[:, 0]
        for step in ([0.0, 0.0], [0.1, 0.0], [0.0, 0.1])
    )
    sides = np.stack([right - here, below - here], axis=1) * 10
    return np.asarray(np.linalg.norm(sides, axis=2))


def _aligned(turned: NDArray[np.uint8], board: Board, cell: Vector, span: Vector) -> Vector | None:
    """A corner's displacement, in squares; None where the picture does not resemble the print."""
    reach, (x, y) = round(REACH * CELL_PX), np.round(cell * CELL_PX).astype(int).tolist()
    part = (slice(y - reach, y + reach), slice(x - reach, x + reach))
    blur = np.maximum(BLUR_PX * CELL_PX / np.maximum(span, 1.0), 0.5)
    printed = cv2.GaussianBlur(_print(board), (0, 0), sigmaX=blur[0], sigmaY=blur[1])[part]
    shift = np.eye(2, 3, dtype=np.float32)
    try:
        like, shift = cv2.findTransformECC(
            printed, turned[part].astype(np.float32), shift, cv2.MOTION_TRANSLATION, ROUNDS
        )
    except cv2.error:  # it does not converge where there is no corner
        return None
    off = shift[:, 2].astype(np.float64)
    if like < LIKE or np.abs(off).max() > reach / 2:
        return None
    return np.asarray(cell + off / CELL_PX)


@lru_cache(maxsize=2)
def _print(board: Board) -> NDArray[np.float32]:
    """The print, CELL_PX a square, sampled like `turned`: corners lie between pixels."""
    picture = np.full((board.rows * CELL_PX * 4, board.columns * CELL_PX * 4), 255, np.float32)
    for left, top, width, height in black_cells(board):
        x, y, right, bottom = (
            round(edge * CELL_PX * 4) for edge in (left, top, left + width, top + height)
        )
        picture[y:bottom, x:right] = 0
    return np.asarray(cv2.resize(picture, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA))
