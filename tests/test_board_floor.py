"""The floor and its world by boards whose places are known."""

import cv2
import numpy as np
import pytest

from calibration.board.board import BOARDS, corner_places
from calibration.board.board_floor import Floor, floor_of, world_cameras
from calibration.board.lens_start import Place
from common.body.body import Vector
from common.rig.rig_file import CalibrationError

PLACES = corner_places(BOARDS["a3"]._replace(square_m=0.1))
CAMERA_UP = np.array([0.0, -1.0, 0.0])
"""In a picture's axes, x right, y down, z ahead, of a level camera."""
LEVEL = Place(np.zeros(3), np.zeros(3))


def lying(below_m: float, ahead_m: float = 4.0) -> Place:
    """A board whose print faces up, so far below the camera."""
    turn = np.stack([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]], axis=1)
    return Place(cv2.Rodrigues(turn)[0].ravel(), np.array([-0.3, below_m, ahead_m]))


def held(below_m: float) -> Place:
    """A board that faces the camera."""
    return Place(np.zeros(3), np.array([-0.3, below_m, 3.0]))


def height_m(floor: Floor, point: Vector) -> float:
    return float((point - floor.origin) @ floor.up)


def test_the_last_board_that_lies_below_all_others_is_the_floor() -> None:
    """A table first, 0.7 m higher; then the floor twice, and boards in the hand."""
    boards = [held(0.2), lying(0.5), held(0.9), lying(1.2), lying(1.2, 3.0), held(0.1)]
    found = floor_of(boards, (LEVEL,), PLACES, None)
    assert found.up == pytest.approx(CAMERA_UP, abs=1e-9)
    assert found.rests == (3, 4)
    assert height_m(found, np.zeros(3)) == pytest.approx(1.2)
    middle = PLACES.mean(axis=0)
    assert found.origin[0] == pytest.approx(-0.3 + middle[0])
    assert found.origin[2] == pytest.approx(3.0, abs=0.3)


def test_a_rest_that_is_named_is_the_floor_whatever_lies_below() -> None:
    boards = [lying(0.5), lying(1.2), held(0.2)]
    found = floor_of(boards, (LEVEL,), PLACES, 0)
    assert found.rests == (0,)
    assert height_m(found, np.zeros(3)) == pytest.approx(0.5)


@pytest.mark.parametrize(
    "board",
    [lying(0.05), lying(-0.5), held(1.0)],
    ids=["at the camera's height", "over the camera", "facing it"],
)
def test_what_is_no_floor_is_told_with_the_cure(board: Place) -> None:
    with pytest.raises(CalibrationError, match=r"lay it down for two seconds.*--floor SECONDS"):
        floor_of([board], (LEVEL,), PLACES, None)


def test_a_board_that_another_was_below_is_no_floor_by_more_than_five_centimetres() -> None:
    assert floor_of([lying(1.24), lying(1.2)], (LEVEL,), PLACES, None).rests == (1,)
    found = floor_of([lying(1.27), lying(1.2)], (LEVEL,), PLACES, None)
    assert height_m(found, np.zeros(3)) == pytest.approx(1.27)
    both = floor_of([lying(1.215), lying(1.2)], (LEVEL,), PLACES, None)
    assert both.rests == (0, 1), "within two centimetres"
    assert height_m(both, np.zeros(3)) == pytest.approx(1.2075, abs=1e-3)


def test_a_world_has_y_up_and_camera_1_on_its_z() -> None:
    """A level camera 1.2 m high, 4 m before the origin; another at its right, looking left."""
    floor = Floor(CAMERA_UP, np.array([0.0, 1.2, 4.0]), (0,))
    left = cv2.Rodrigues(np.array([0.0, np.radians(90.0), 0.0]))[0]
    second = Place(cv2.Rodrigues(left)[0].ravel(), -left @ np.array([4.0, 0.0, 4.0]))
    (R, t), (R2, t2) = world_cameras((LEVEL, second), floor)
    assert -R.T @ t == pytest.approx([0.0, 1.2, 4.0])
    assert pytest.approx(np.diag([1.0, -1.0, -1.0]), abs=1e-9) == R
    assert -R2.T @ t2 == pytest.approx([4.0, 1.2, 0.0], abs=1e-9)
    assert np.linalg.det(R2) == pytest.approx(1.0)


def test_where_camera_1_looks_straight_down_z_is_down_in_its_picture() -> None:
    down = Floor(np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 3.0]), (0,))
    ((R, t),) = world_cameras((LEVEL,), down)
    assert pytest.approx([0.0, 1.0, 0.0]) == R @ [0.0, 0.0, 1.0]
    assert -R.T @ t == pytest.approx([0.0, 3.0, 0.0])
    slanted = Floor(np.array([0.0, -0.2, -np.sqrt(0.96)]), np.array([0.0, 0.0, 3.0]), (0,))
    ((R, _),) = world_cameras((LEVEL,), slanted)
    assert (R.T @ [0.0, 0.0, -1.0])[2] > 0.15, "z is towards camera 1 where it looks ahead a bit"
