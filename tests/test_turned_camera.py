"""A camera that is turned where it stands, held against what it projects."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.rig.camera import arrays_of, centre, paper_rig, project
from common.rig.turned_camera import angle_deg, shift_of, turn_of, turned
from common.rig.upright import Shift

CAMERA = paper_rig((160, 120), (200.0, 180.0), (4.0, 4.0)).cameras[1]
FOCAL_PX = arrays_of(CAMERA).focal_px


@given(st.integers(-6000, 6000), st.integers(-6000, 6000), st.integers(-4000, 4000))
def test_a_shift_is_the_shift_of_its_turn(right: int, down: int, roll: int) -> None:
    """In hundredths of pixels and degrees: to OpenCV turns under 1e-5 radians are none."""
    shift = (right / 100, down / 100, roll / 100)
    told = shift_of(turn_of(Shift(*shift), FOCAL_PX), FOCAL_PX)
    assert (told.right_px, told.down_px, told.roll_deg) == pytest.approx(shift)


def test_what_was_in_the_middle_is_where_the_shift_has_it() -> None:
    place_m = np.array([[1.0, 1.0, 0.0]])
    assert project(CAMERA, place_m)[0] == pytest.approx((80.0, 60.0))
    other = turned(CAMERA, turn_of(Shift(12.0, -5.0, 20.0), FOCAL_PX))
    assert project(other, place_m)[0] == pytest.approx((92.0, 55.0))
    assert centre(other) == pytest.approx(centre(CAMERA))


def test_a_rolled_picture_turns_clockwise_about_its_middle() -> None:
    camera = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0)).cameras[0]
    rolled = turned(camera, turn_of(Shift(0.0, 0.0, 90.0), arrays_of(camera).focal_px))
    right = np.array([[0.4, 1.0, 0.0]])
    assert project(camera, right)[0] == pytest.approx((100.0, 60.0))
    assert project(rolled, right)[0] == pytest.approx((80.0, 80.0))


def test_a_turn_is_told_in_degrees() -> None:
    assert angle_deg(np.eye(3)) == 0.0
    assert angle_deg(cv2.Rodrigues(np.array([0.0, 0.1, 0.0]))[0]) == pytest.approx(5.729578)
