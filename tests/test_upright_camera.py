"""Cameras made upright: what they show stays where it is in the world, and comes back."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lying_cameras import lying

from common.rig.camera import Camera, as_matrix, as_row, paper_rig, project
from common.rig.rig_file import CalibrationError
from common.rig.upright_camera import (
    as_filed,
    as_worked_on,
    filed_camera,
    upright_camera,
    upright_of,
)
from common.video.reduction import reduced

SIZE: Final = (320, 240)
LEVEL: Final = paper_rig(SIZE, (400.0, 400.0), (4.5, 4.5)).cameras[0]
BENT: Final = (-0.1, 0.05, 0.004, -0.006, 0.01, 0.02, -0.01, 0.005, 0.003, -0.002, 0.004, 0.001)
"""OpenCV's first twelve numbers: radial, tangential, rational, thin prism."""
points = st.lists(st.floats(-0.8, 0.8), min_size=3, max_size=3)
rolls = st.floats(0.0, 360.0)


def rolled(deg: float, aspect: float = 1.0, bent: tuple[float, ...] = ()) -> Camera:
    cos, sin = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    K = ((400.0 * aspect, 0.0, 150.0), (0.0, 400.0, 130.0), (0.0, 0.0, 1.0))
    R, t = turn @ np.array(LEVEL.R), turn @ np.array(LEVEL.t)
    return Camera("cam1", K, as_matrix(R), as_row(t), bent)


@pytest.mark.parametrize("bent", [(), BENT[:4], BENT[:5], BENT[:8], BENT])
@given(deg=rolls, aspect=st.sampled_from((0.75, 1.0, 1.42)), place=points)
def test_a_place_is_shown_where_the_turned_picture_has_it(
    bent: tuple[float, ...], deg: float, aspect: float, place: list[float]
) -> None:
    camera, point = rolled(deg, aspect, bent), np.array([place]) + np.array([0.0, 1.0, 0.0])
    upright = upright_of(camera, SIZE)
    worked = upright_camera(camera, upright)
    filed = project(camera, point)
    assert project(worked, point) == pytest.approx(as_worked_on(filed, upright), abs=1e-6)
    assert as_filed(project(worked, point), upright) == pytest.approx(filed, abs=1e-6)
    assert project(filed_camera(worked, upright), point) == pytest.approx(filed, abs=1e-6)


@given(deg=rolls, aspect=st.sampled_from((0.75, 1.0, 1.42)))
def test_what_is_worked_on_is_upright_within_45_degrees_and_has_square_pixels(
    deg: float, aspect: float
) -> None:
    camera = rolled(deg, aspect)
    worked = upright_camera(camera, upright_of(camera, SIZE))
    feet, head = project(worked, np.array([[0.0, 0.9, 0.0], [0.0, 1.1, 0.0]]))
    across, up = head[0] - feet[0], feet[1] - head[1]
    assert up >= abs(across) - 1e-6
    assert worked.K[0][0] == pytest.approx(worked.K[1][1], rel=0.003)


@pytest.mark.parametrize("quarters", [0, 1, 2, 3])
def test_a_camera_that_lies_is_the_one_that_stands_again(quarters: int) -> None:
    """By the pixels of a picture that is turned by hand."""
    camera = lying(LEVEL, SIZE, quarters)
    size = SIZE[::-1] if quarters % 2 else SIZE
    upright = upright_of(camera, size)
    assert upright_camera(camera, upright) == LEVEL
    assert (upright is None) == (quarters == 0)
    assert upright is None or upright.size == SIZE


def test_pixels_that_are_nearly_square_stay_as_they_are() -> None:
    assert upright_of(rolled(0.0, 0.995), SIZE) is None
    assert upright_of(rolled(0.0, 0.98), SIZE) is not None


def test_a_sensor_that_is_tilted_cannot_be_turned_and_says_so() -> None:
    camera = rolled(90.0, bent=(*BENT, 0.01, 0.0))
    with pytest.raises(CalibrationError, match=r"camera cam1 is rolled .*turn its video upright"):
        upright_camera(camera, upright_of(camera, SIZE))
    level = rolled(0.0, bent=(*BENT, 0.01, 0.0))
    assert upright_camera(level, upright_of(level, SIZE)) == level


@pytest.mark.parametrize("deg", [0.0, 90.0, 180.0, 270.0])
@pytest.mark.parametrize("aspect", [0.75, 1.0, 1.5])
def test_the_decoder_turns_pictures_as_cameras_are_turned(deg: float, aspect: float) -> None:
    """A bright spot is found where the turned camera has it; wide pixels become squares."""
    upright = upright_of(rolled(deg, aspect), SIZE)
    picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    picture[60:72, 200:212] = 255
    size, quarters = (SIZE, 0) if upright is None else (upright.size, upright.quarters)
    worked = reduced(picture, size, quarters)
    assert worked.shape == (size[1], size[0], 3)
    rows, columns = np.nonzero(worked[..., 0] > 127)
    (wanted,) = as_worked_on(np.array([[206.0, 66.0]]), upright)
    assert [columns.mean() + 0.5, rows.mean() + 0.5] == pytest.approx(wanted, abs=0.5)
