"""Corners held against the print round them: what is looked at, and how large it is."""

import cv2
import numpy as np
import pytest

from calibration.board.board import BOARDS
from calibration.board.corner_alignment import CELL_PX, _aligned, _inside, _print, _spans_px

ONTO = np.array([[40.0, 0.0, 10.0], [0.0, 24.0, 6.0], [0.0, 0.0, 1.0]])
"""Squares of 40 x 24 px; the board's top left is at (10, 6)."""
BOARD = BOARDS["a4"]


def test_a_square_takes_as_many_pixels_as_it_is_wide_and_high() -> None:
    turned = np.array([[0.0, -24.0, 100.0], [40.0, 0.0, 6.0], [0.0, 0.0, 1.0]])
    cells = np.array([[1.0, 2.0], [3.0, 1.0]])
    assert _spans_px(ONTO, cells) == pytest.approx(np.array([[40.0, 24.0]] * 2), rel=1e-4)
    assert _spans_px(turned, cells) == pytest.approx(np.array([[40.0, 24.0]] * 2), rel=1e-4)


def test_a_corner_counts_where_half_a_square_round_it_is_in_the_picture() -> None:
    """Round (1, 1) it reaches from (30, 18) to (70, 42)."""
    cells = np.array([[1.0, 1.0]])
    for shape, is_inside in (
        ((44, 72), True),
        ((44, 71), False),
        ((43, 72), False),
        ((44, 72, 3), True),
    ):
        assert _inside(ONTO, cells, shape).tolist() == [is_inside]
    for right_px, down_px, is_inside in (
        (-29.0, 0.0, True),
        (-31.0, 0.0, False),
        (0.0, -19.0, False),
    ):
        moved = ONTO.copy()
        moved[:2, 2] += (right_px, down_px)
        assert _inside(moved, cells, (200, 200)).tolist() == [is_inside]


@pytest.mark.parametrize(("right_px", "down_px"), [(0.0, 0.0), (3.0, -2.0), (-1.5, 4.0)])
def test_a_corner_is_where_the_print_fits_the_picture(right_px: float, down_px: float) -> None:
    moved = np.array([[1.0, 0.0, right_px], [0.0, 1.0, down_px]])
    picture = cv2.warpAffine(
        _print(BOARD), moved, _print(BOARD).shape[::-1], borderValue=255.0
    ).astype(np.uint8)
    cell = np.array([2.0, 1.0])
    found = _aligned(picture, BOARD, cell, np.array([40.0, 40.0]))
    assert found is not None
    assert found == pytest.approx(cell + np.array([right_px, down_px]) / CELL_PX, abs=0.004)
    far = cv2.warpAffine(
        _print(BOARD), np.array([[1.0, 0, 10.0], [0, 1.0, 0]]), picture.shape[::-1]
    )
    astray = _aligned(far.astype(np.uint8), BOARD, cell, np.array([40.0, 40.0]))
    assert astray is None or abs(astray[0] - cell[0]) * CELL_PX <= 8.0
    grey = np.random.default_rng(1).integers(100, 120, picture.shape).astype(np.uint8)
    assert _aligned(grey, BOARD, cell, np.array([40.0, 40.0])) is None
