"""Line markers, held against cameras that were turned by known angles (P42)."""

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calibration.paper.markers import MarkerView, fitted_lines, line_markers
from common.body.body import Vector
from common.body.observation import Pixel
from common.rig.camera import Camera, as_matrix, as_row, centre, paper_rig, project
from common.rig.rig_file import CalibrationError

SIZE = (160, 120)
FOCAL_PX = 150.0
angles = st.floats(-8.0, 8.0)


def turned(camera: Camera, yaw_deg: float, pitch_deg: float, roll_deg: float) -> Camera:
    """The camera turned right, then up, then clockwise about its own axes, where it stands."""
    y, p, r = (math.radians(angle) for angle in (yaw_deg, pitch_deg, roll_deg))
    about_y = [[math.cos(y), 0, math.sin(y)], [0, 1, 0], [-math.sin(y), 0, math.cos(y)]]
    about_x = [[1, 0, 0], [0, math.cos(p), -math.sin(p)], [0, math.sin(p), math.cos(p)]]
    about_z = [[math.cos(r), -math.sin(r), 0], [math.sin(r), math.cos(r), 0], [0, 0, 1]]
    axes = np.array(about_y) @ np.array(about_x) @ np.array(about_z)
    R = axes.T @ np.array(camera.R)
    return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(-R @ centre(camera)))


def shown(number: int, camera: Camera, focal_px: float = FOCAL_PX) -> MarkerView:
    """Both markers of a camera: on the ground below its axis, on the wall 3 m behind the centre."""
    height = float(centre(camera)[1])
    along, across = np.linspace(-2.0, 1.0, 6), np.linspace(-1.5, 1.5, 6)
    if number == 1:
        floor = [(0.0, 0.0, z) for z in along]
        wall = [(x, height, -3.0) for x in across]
    else:
        floor = [(-x, 0.0, 0.0) for x in along]
        wall = [(3.0, height, z) for z in across]
    return MarkerView(camera.name, focal_px, pixels(camera, floor), pixels(camera, wall))


def pixels(camera: Camera, points: list[tuple[float, float, float]]) -> tuple[Pixel, ...]:
    seen: Vector = project(camera, np.array(points))
    return tuple((float(u), float(v)) for u, v in seen)


def camera_of(number: int, size: tuple[int, int] = SIZE, focal_px: float = FOCAL_PX) -> Camera:
    return paper_rig(size, (focal_px, focal_px), (4.0, 4.5)).cameras[number - 1]


@pytest.mark.parametrize("number", [1, 2])
def test_an_aimed_camera_shows_its_markers_on_the_papers_lines(number: int) -> None:
    """Section 4.1: columns 80 and 81, rows 60 and 61, one-based, meet at (80, 60) here (C8)."""
    view = shown(number, camera_of(number))
    assert [u for u, _ in view.floor_px] == pytest.approx([80.0] * 6)
    assert [v for _, v in view.wall_px] == pytest.approx([60.0] * 6)
    aim = line_markers(view, SIZE)
    assert msgspec.structs.astuple(aim)[1:] == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("number", [1, 2])
@given(yaw=angles, pitch=angles, roll=angles)
def test_a_known_turn_is_reported_whatever_the_two_others_are(
    number: int, yaw: float, pitch: float, roll: float
) -> None:
    """P42 asks for 0.1 degrees; without reading errors it is exact."""
    aim = line_markers(shown(number, turned(camera_of(number), yaw, pitch, roll)), SIZE)
    assert (aim.yaw_deg, aim.pitch_deg, aim.roll_deg) == pytest.approx((yaw, pitch, roll), abs=1e-6)
    assert aim.skew_deg == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("yaw_deg", [-3.0, 1.0, 5.0])
def test_positions_read_to_the_pixel_are_enough_at_640x480(number: int, yaw_deg: float) -> None:
    """P42: yaw within 0.1 degrees."""
    camera = turned(camera_of(number, (640, 480), 600.0), yaw_deg, 0.7, -0.4)
    view = shown(number, camera, 600.0)
    read = msgspec.structs.replace(
        view, floor_px=to_pixel(view.floor_px), wall_px=to_pixel(view.wall_px)
    )
    aim = line_markers(read, (640, 480))
    assert (aim.yaw_deg, aim.pitch_deg) == pytest.approx((yaw_deg, 0.7), abs=0.1)
    assert aim.roll_deg == pytest.approx(-0.4, abs=0.15)  # a row in 400 columns is 0.14 degrees


def to_pixel(points: tuple[Pixel, ...]) -> tuple[Pixel, ...]:
    return tuple((math.floor(u) + 0.5, math.floor(v) + 0.5) for u, v in points)


def test_markers_that_are_not_square_are_told() -> None:
    """A wall marker that climbs by 2 degrees can be no roll: the floor marker says otherwise."""
    view = shown(1, camera_of(1))
    tilted = tuple((u, v + math.tan(math.radians(2.0)) * (u - 80.0)) for u, v in view.wall_px)
    aim = line_markers(msgspec.structs.replace(view, wall_px=tilted), SIZE)
    assert aim.skew_deg == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    ("floor_px", "says"),
    [
        ((), "floor_px of cam1 is no line"),
        (((80.0, 100.0),), "floor_px of cam1 is no line"),
        (((80.0, 100.0), (80.2, 100.3)), "floor_px of cam1 is no line"),
        (((20.0, 100.0), (140.0, 101.0)), "floor_px of cam1 must run up and down"),
    ],
)
def test_what_is_no_marker_is_refused(floor_px: tuple[Pixel, ...], says: str) -> None:
    view = msgspec.structs.replace(shown(1, camera_of(1)), floor_px=floor_px)
    with pytest.raises(CalibrationError, match=says):
        line_markers(view, SIZE)


@pytest.mark.parametrize("number", [1, 2])
@given(yaw=angles, pitch=angles, roll=angles)
def test_the_fitted_lines_go_through_points_that_were_read_without_error(
    number: int, yaw: float, pitch: float, roll: float
) -> None:
    view = shown(number, turned(camera_of(number), yaw, pitch, roll))
    for line, points in zip(fitted_lines(view, SIZE), (view.floor_px, view.wall_px), strict=True):
        assert np.column_stack([points, np.ones(len(points))]) @ line == pytest.approx(
            0.0, abs=1e-6
        )


def test_a_point_is_off_its_line_by_its_distance_in_pixels() -> None:
    """A single point 3 px to the right of many on the centre column."""
    view = shown(1, camera_of(1))
    many = tuple((80.0, 70.0 + v) for v in range(50))
    line, _ = fitted_lines(msgspec.structs.replace(view, floor_px=many), SIZE)
    assert abs(line @ (83.0, 95.0, 1.0)) == pytest.approx(3.0)
