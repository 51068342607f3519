"""Boards, held against the pictures that OpenCV draws of them."""

import cv2
import numpy as np
import pytest

from calibration.board.board import (
    BOARDS,
    SHEETS_MM,
    Board,
    Paper,
    black_cells,
    charuco,
    chessboard,
    corner_places,
)
from common.rig.rig_file import CalibrationError


@pytest.mark.parametrize("paper", ["a4", "a3"])
def test_what_is_black_is_what_opencv_draws(paper: Paper) -> None:
    board, side = BOARDS[paper], 48
    ours = np.full((board.rows * side, board.columns * side), 255, np.uint8)
    for left, top, width, height in black_cells(board):
        x, y, right, bottom = (
            round(edge * side) for edge in (left, top, left + width, top + height)
        )
        ours[y:bottom, x:right] = 0
    theirs = charuco(board).generateImage((board.columns * side, board.rows * side), None, 0, 1)
    assert np.mean(ours != theirs) < 0.01  # edges, by a pixel


@pytest.mark.parametrize("paper", ["a4", "a3"])
def test_a_board_fits_its_sheet_with_the_margin_that_printers_keep(paper: Paper) -> None:
    board, (width, height) = BOARDS[paper], SHEETS_MM[paper]
    assert board.columns * board.square_m * 1e3 + 2 * 5 <= width
    assert board.rows * board.square_m * 1e3 + 2 * 5 <= height


def test_no_marker_is_on_two_boards() -> None:
    numbers = [set(np.ravel(charuco(board).getIds()).tolist()) for board in BOARDS.values()]
    assert not numbers[0] & numbers[1]


def test_corners_are_numbered_as_opencv_numbers_them() -> None:
    board = BOARDS["a3"]
    theirs = np.array(charuco(board).getChessboardCorners()) * board.square_m
    assert corner_places(board) == pytest.approx(theirs, abs=1e-6)


def test_a_chessboard_is_named_by_its_squares() -> None:
    assert chessboard("9x6", 0.03) == Board(9, 6, 0.03, None)


@pytest.mark.parametrize(
    ("squares", "said"),
    [("9", "no count of squares"), ("8x8", "the same turned about"), ("3x2", "4 to 30 each way")],
)
def test_a_chessboard_that_does_not_do_is_refused_with_the_cure(squares: str, said: str) -> None:
    with pytest.raises(CalibrationError, match=said):
        chessboard(squares, 0.03)


def test_the_markers_are_of_the_dictionary_that_is_looked_for() -> None:
    assert charuco(BOARDS["a4"]).getDictionary().markerSize == 4
    assert cv2.aruco.DICT_4X4_50 == 0
