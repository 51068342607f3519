"""Corners, held against the camera that the picture was made with."""

import numpy as np
import pytest
from filmed_board import Pose, Studio, facing, middle_of

from calibration.board.board import BOARDS, Board, corner_places
from calibration.board.board_corners import corners_in
from common.body.body import Vector
from common.rig.camera import Camera, project

SIZE = (640, 480)
AHEAD = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
BENT = Camera(
    "cam1",
    ((600.0, 0.0, 322.0), (0.0, 600.0, 238.0), (0.0, 0.0, 1.0)),
    AHEAD,
    (0.0, 0.0, 0.0),
    (-0.2, 0.05, 0.0, 0.0),
)
TOWARDS = np.array([0.0, 0.0, -1.0])
CHESSBOARD = Board(7, 6, 0.06, None)


def off_px(board: Board, pose: Pose) -> Vector:
    """(n, 2) what the corners that are found are off."""
    found = corners_in(Studio(BENT, SIZE, 3).picture(board, pose), board)
    assert found is not None
    places = (corner_places(board) - middle_of(board)) @ pose.turn.T + pose.middle_m
    return np.asarray(found + 0.5 - project(BENT, places))


@pytest.mark.parametrize("board", [*BOARDS.values(), CHESSBOARD], ids=["a4", "a3", "chess"])
@pytest.mark.parametrize("roll", [0.0, 1.2, 3.1], ids=["upright", "on its side", "turned about"])
def test_corners_are_known_to_a_twentieth_of_a_pixel(board: Board, roll: float) -> None:
    """Of a slanted board, blurred and noisy, before a lens that bends; whichever way it is held."""
    far_m = board.square_m * 24
    slanted = TOWARDS + np.array([0.5, 0.3, 0.0])
    off = off_px(board, Pose(facing(slanted, roll), np.array([0.1, -0.05, far_m])))
    assert np.isfinite(off).all()
    assert np.sqrt(np.mean(off**2)) < 0.05


def test_small_squares_are_found_and_known_as_well() -> None:
    """Sixteen pixels a square: ten a marker."""
    board = BOARDS["a3"]
    pose = Pose(facing(TOWARDS, 0.2), np.array([0.2, 0.1, board.square_m * 600 / 16]))
    off = off_px(board, pose)
    assert np.isfinite(off[:, 0]).sum() >= 10
    assert np.sqrt(np.nanmean(off**2)) < 0.05


def test_what_the_picture_cuts_off_is_not_told() -> None:
    board = BOARDS["a3"]
    off = off_px(board, Pose(facing(TOWARDS, 0.0), np.array([-0.4, 0.0, 0.9])))
    assert 6 <= np.isfinite(off[:, 0]).sum() < len(off)
    assert np.nanmax(np.abs(off)) < 0.2


@pytest.mark.parametrize("board", [BOARDS["a4"], CHESSBOARD], ids=["a4", "chess"])
def test_a_room_without_the_board_shows_none(board: Board) -> None:
    assert corners_in(Studio(BENT, SIZE, 3).picture(board, None), board) is None


def test_the_board_of_another_sheet_is_not_taken_for_this_one() -> None:
    pose = Pose(facing(TOWARDS, 0.0), np.array([0.0, 0.0, 1.2]))
    picture = Studio(BENT, SIZE, 3).picture(BOARDS["a3"], pose)
    assert corners_in(picture, BOARDS["a4"]) is None
