"""Where the body is, held against points projected into both pictures (sections 4.2 and 4.4)."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from staging import RIG

from common.body.body import Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre, paper_rig, project
from integrator.rig.body_position import (
    AHEAD_M,
    Roots,
    pixels_of,
    place_of,
    scales_at,
    scales_since,
)

metres = st.floats(-1.2, 1.2)
ORIGIN = np.zeros(3)


def free(name: str, place: Vector, yaw_deg: float) -> Camera:
    """A camera somewhere, looking somewhere: no rig of the paper's kind."""
    turn = Rotation.from_euler("yx", [yaw_deg, 5.0], degrees=True).as_matrix()
    R = np.diag([1.0, -1.0, -1.0]) @ turn.T
    K = ((180.0, 0.0, 80.0), (0.0, 180.0, 60.0), (0.0, 0.0, 1.0))
    return Camera(name, K, as_matrix(R), as_row(-R @ place))


FREE = Rig(
    160,
    120,
    (free("a", np.array([1.0, 1.5, 4.0]), 20.0), free("b", np.array([-3.5, 1.2, 2.0]), -50.0)),
)


def seen(rig: Rig, point: Vector) -> tuple[tuple[float, float], tuple[float, float]]:
    first, second = (tuple(map(float, project(c, point[None])[0])) for c in rig.cameras)
    return first, second  # type: ignore[return-value]


@pytest.mark.parametrize("rig", [RIG, FREE], ids=["paper's", "free"])
@pytest.mark.parametrize("facade", [0, 1])
@given(x=metres, y=st.floats(0.3, 1.5), z=metres)
def test_two_views_give_back_the_place(rig: Rig, facade: int, x: float, y: float, z: float) -> None:
    """P44, P50: X from viewer 1, Z from viewer 2, both at once (eq. 3); rays in any other rig."""
    point = np.array([x, y, z])
    assert place_of(rig, seen(rig, point), ORIGIN, facade) == pytest.approx(point, abs=1e-9)


@pytest.mark.parametrize("facade", [0, 1])
def test_the_height_comes_from_the_facade(facade: int) -> None:
    """P50: the other view's row does not count in the paper's rig."""
    point = np.array([0.2, 0.9, -0.3])
    roots = [list(pixel) for pixel in seen(RIG, point)]
    roots[1 - facade][1] += 25.0
    moved: Roots = ((roots[0][0], roots[0][1]), (roots[1][0], roots[1][1]))
    assert place_of(RIG, moved, ORIGIN, facade) == pytest.approx(point, abs=1e-9)
    roots[facade][1] += 5.0
    lower: Roots = ((roots[0][0], roots[0][1]), (roots[1][0], roots[1][1]))
    scale = scales_at(RIG, point)[facade]
    assert place_of(RIG, lower, ORIGIN, facade)[1] == pytest.approx(0.9 - 5.0 / scale)


@pytest.mark.parametrize("rig", [RIG, FREE], ids=["paper's", "free"])
@pytest.mark.parametrize("alone", [0, 1])
def test_one_view_alone_keeps_the_depth_that_was(rig: Rig, alone: int) -> None:
    """P50: a body that moves across the line of sight is followed, one along it is not."""
    before, camera = np.array([0.1, 0.9, 0.2]), rig.cameras[alone]
    across = np.array(camera.R)[0]
    now = before + 0.3 * across
    pixel = seen(rig, now)[alone]
    roots: Roots = (pixel, None) if alone == 0 else (None, pixel)
    assert place_of(rig, roots, before, 0) == pytest.approx(now, abs=1e-9)


@pytest.mark.parametrize("alone", [0, 1])
def test_one_view_whose_camera_has_the_origin_behind_it_takes_a_rooms_depth(alone: int) -> None:
    """P50: a calibration's origin may be anywhere; the body is before the camera all the same."""
    behind = (0.0, 0.0, -1.5)
    cameras = tuple(msgspec.structs.replace(camera, t=behind) for camera in FREE.cameras)
    rig = msgspec.structs.replace(FREE, cameras=cameras)
    roots: Roots = ((60.0, 50.0), None) if alone == 0 else (None, (60.0, 50.0))
    place = place_of(rig, roots, ORIGIN, 0)
    assert seen(rig, place)[alone] == pytest.approx((60.0, 50.0))
    assert scales_at(rig, place)[alone] == pytest.approx(180.0 / AHEAD_M)


@pytest.mark.parametrize("facade", [0, 1])
def test_views_that_cannot_mean_one_person_leave_the_depth_as_it_was(facade: int) -> None:
    """P44: rays that part before the cameras meet behind them; the facade's view is believed."""
    places = (np.array([1.0, 1.2, 4.0]), np.array([-1.0, 1.2, 4.0]))
    parallel = tuple(free(name, place, 0.0) for name, place in zip("ab", places, strict=True))
    rig, before = Rig(160, 120, parallel), np.array([0.0, 0.9, 0.0])
    roots: Roots = ((150.0, 60.0), (10.0, 60.0))
    place = place_of(rig, roots, before, facade)
    assert seen(rig, place)[facade] == pytest.approx(roots[facade])
    assert scales_at(rig, place)[facade] == pytest.approx(scales_at(rig, before)[facade])


def test_a_metre_is_the_focal_length_over_the_depth() -> None:
    """C1: x1 = lambda1 X / (Zc1 - Z), z2 = lambda2 Z / (X - Xc2)."""
    rig = paper_rig((160, 120), (200.0, 150.0), (4.0, 3.0))
    assert scales_at(rig, np.array([0.5, 1.0, -1.0])) == pytest.approx((200 / 5.0, 150 / 3.5))


@given(x=metres, z=metres, x0=metres, z0=metres)
def test_factors_since_the_measure_lead_to_the_scale_that_is(
    x: float, z: float, x0: float, z0: float
) -> None:
    """P45, M5: reference scale times r_t,n is the scale, wherever the body was measured."""
    now, then = np.array([x, 0.9, z]), np.array([x0, 0.9, z0])
    for rig in (RIG, FREE):
        assert scales_since(rig, now, then) == pytest.approx(scales_at(rig, now))


def test_pictures_show_the_world_as_the_conventions_say() -> None:
    """C1, C2, C8: image right is +X in picture 1 and +Z in picture 2, rows run down.

    The axis meets the middle of a 160x120 picture: (80, 60) counted from corners, 79.5 and 59.5
    in the numbers of pixels, between columns 80 and 81 one-based.
    """
    middle, right, front, up = (
        pixels_of(RIG, np.array(point))
        for point in ([0, 1, 0], [0.5, 1, 0], [0, 1, 0.5], [0, 1.5, 0])
    )
    assert middle == ((80.0, 60.0), (80.0, 60.0))
    assert right[0] == pytest.approx((80.0 + 0.5 * 50, 60.0))
    assert front[1] == pytest.approx((80.0 + 0.5 * 50, 60.0))
    assert up[0][1] == pytest.approx(60.0 - 0.5 * 50)


def test_a_place_behind_a_camera_is_expected_in_the_middle() -> None:
    behind = centre(RIG.cameras[0]) + np.array([0.3, 0.0, 1.0])
    assert pixels_of(RIG, behind)[0] == (80.0, 60.0)
