"""Where the body is, held against the pinhole and the paper's printed equations (4.2 and 4.4)."""

import math
from typing import Final

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from staging import RIG

from common.body.body import Vector
from common.rig.camera import (
    PAPER_ROTATIONS,
    Camera,
    PaperRig,
    Rig,
    as_matrix,
    as_paper_rig,
    as_row,
    centre,
    paper_rig,
    project,
)
from integrator.rig.body_position import (
    AHEAD_M,
    Roots,
    ground_position,
    pixels_of,
    place_of,
    scales_at,
    scales_since,
    scaling_factors,
    triangulate,
    upright_place_of,
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


def nearly(camera: Camera) -> Camera:
    """Turned by 0.95 degrees about the vertical, 4.9 cm aside."""
    R = np.array(camera.R) @ Rotation.from_euler("y", 0.95, degrees=True).as_matrix()
    place = centre(camera) + np.array([0.0, 0.0, 0.049])
    return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(-R @ place))


NEARLY = msgspec.structs.replace(RIG, cameras=(RIG.cameras[0], nearly(RIG.cameras[1])))
"""What was taken for the paper's rig."""


@pytest.mark.parametrize("rig", [RIG, FREE], ids=["paper's", "free"])
@pytest.mark.parametrize("facade", [0, 1])
@given(x=metres, y=st.floats(0.3, 1.5), z=metres)
def test_two_views_give_back_the_place(rig: Rig, facade: int, x: float, y: float, z: float) -> None:
    """P44, P50: X from viewer 1, Z from viewer 2, both at once (eq. 3); rays in any other rig."""
    point = np.array([x, y, z])
    assert place_of(rig, seen(rig, point), ORIGIN, facade) == pytest.approx(point, abs=1e-9)


@pytest.mark.parametrize("facade", [0, 1])
@given(x=metres, y=st.floats(0.3, 1.5), z=metres)
def test_a_rig_that_nearly_is_the_papers_is_what_it_is(
    facade: int, x: float, y: float, z: float
) -> None:
    """Its camera 2 turned by 0.95 degrees, 4.9 cm aside: as the paper's it was 200 mm off."""
    point, roots = np.array([x, y, z]), seen(NEARLY, np.array([x, y, z]))
    assert place_of(NEARLY, roots, ORIGIN, facade) == pytest.approx(point, abs=1e-9)
    found = upright_place_of(NEARLY, *roots)
    assert found == pytest.approx(point, abs=1e-9)
    assert scales_since(NEARLY, found, ORIGIN) == pytest.approx(scales_at(NEARLY, point))


@pytest.mark.parametrize("facade", [0, 1])
@given(x=metres, y=st.floats(0.3, 1.5), z=metres)
def test_rows_are_scaled_by_their_own_focal_length(
    facade: int, x: float, y: float, z: float
) -> None:
    """P50 with pixels that are wider than high, as a video of 1440x1080 has them."""
    cameras = tuple(
        msgspec.structs.replace(camera, K=as_matrix(np.diag([0.75, 1.0, 1.0]) @ np.array(camera.K)))
        for camera in RIG.cameras
    )
    rig, point = msgspec.structs.replace(RIG, cameras=cameras), np.array([x, y, z])
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


ROOM: Final = PaperRig(150.0, 150.0, 4.0, 4.0)
"""The rig that the requirements' figures are for: 37 px to a metre at 4 m."""

places = st.floats(-2.0, 2.0)
focals = st.floats(50.0, 2000.0)
distances = st.floats(2.5, 12.0)
rigs = st.builds(PaperRig, focals, focals, distances, distances)


def columns_of(x_m: float, z_m: float, rig: PaperRig) -> tuple[float, float]:
    """x1 and z2 of a point by the pinhole (C1)."""
    return (
        rig.focal_1_px * x_m / (rig.distance_1_m - z_m),
        rig.focal_2_px * z_m / (x_m + rig.distance_2_m),
    )


def printed_eq_3(x1: float, z2: float, rig: PaperRig) -> tuple[float, float]:
    """Eq. (3) as printed, with X_c2 for x_c2 (M3)."""
    l1, l2, zc1, xc2 = rig.focal_1_px, rig.focal_2_px, rig.distance_1_m, -rig.distance_2_m
    return (zc1 * l2 + z2 * xc2) / (l1 * l2 / x1 + z2), (x1 * zc1 - xc2 * l1) / (l1 * l2 / z2 + x1)


def printed_eq_4(x: float, z: float, a: tuple[float, float], rig: PaperRig) -> float:
    """r_t1 of eq. (4) as printed, the reference being at `a`."""
    x1d, x1a = columns_of(x, z, rig)[0], columns_of(*a, rig)[0]
    focal, zc1 = rig.focal_1_px, rig.distance_1_m
    return zc1 * math.hypot(focal, x1d) / (math.hypot(focal, x1a) * math.hypot(zc1 - z, x))


def test_eq_3_gives_back_the_place_in_a_hundred_thousand_rigs() -> None:
    """P44: exact, not approximate."""
    random = np.random.default_rng(3)
    many = (100_000,)
    x, z = random.uniform(-2, 2, many), random.uniform(-2, 2, many)
    focal_1, focal_2 = random.uniform(50, 2000, (2, *many))
    distance_1, distance_2 = random.uniform(2.5, 12, (2, *many))
    columns = focal_1 * x / (distance_1 - z), focal_2 * z / (x + distance_2)
    rig: object = PaperRig(*(np.asarray(n) for n in (focal_1, focal_2, distance_1, distance_2)))  # type: ignore[arg-type]
    got = ground_position(*columns, rig)  # type: ignore[arg-type]
    assert np.abs(np.array(got) - (x, z)).max() < 1e-9


@given(places, places, rigs)
def test_the_finite_form_is_the_printed_one_off_the_axes(
    x_m: float, z_m: float, rig: PaperRig
) -> None:
    """M4: same values wherever the printed form has any."""
    x1, z2 = columns_of(x_m, z_m, rig)
    if min(abs(x1), abs(z2)) > 1e-3:
        assert ground_position(x1, z2, rig) == pytest.approx(printed_eq_3(x1, z2, rig), abs=1e-9)


@given(rigs, places)
def test_points_on_the_axes_are_finite(rig: PaperRig, m: float) -> None:
    """M4: the printed form is 0/0 at the calibrated start."""
    assert ground_position(0.0, 0.0, rig) == (0.0, 0.0)
    assert ground_position(*columns_of(m, 0.0, rig), rig) == pytest.approx((m, 0.0), abs=1e-9)
    assert ground_position(*columns_of(0.0, m, rig), rig) == pytest.approx((0.0, m), abs=1e-9)


def test_leaving_eq_3_out_costs_what_the_requirements_say() -> None:
    """P44: X = x Zc1 / lambda1 is 125 mm off at (0.5, 0.8); a pixel is 27 mm at 4 m."""
    x1, z2 = columns_of(0.5, 0.8, ROOM)
    assert abs(x1 * 4.0 / 150.0 - 0.5) == pytest.approx(0.125, abs=0.0005)
    assert abs(ground_position(x1, z2, ROOM)[0] - 0.5) < 1e-12
    assert ground_position(1.0, 0.0, ROOM)[0] == pytest.approx(0.027, abs=0.0005)


@pytest.mark.parametrize(("yaw_deg", "off_mm"), [(1.0, 78), (5.0, 393)])
def test_a_turned_camera_2_moves_the_body_by_what_the_requirements_say(
    yaw_deg: float, off_mm: float
) -> None:
    """P42: why the line markers matter, at (0.5, 0.5)."""
    rig = paper_rig((160, 120), (150.0, 150.0), (4.0, 4.0))
    yaw = math.radians(yaw_deg)
    turn = np.array(
        [[math.cos(yaw), 0, math.sin(yaw)], [0, 1, 0], [-math.sin(yaw), 0, math.cos(yaw)]]
    )
    pixels = [project(rig.cameras[0], np.array([[0.5, 1.0, 0.5]]))[0]]
    x_cam = turn @ (np.array(PAPER_ROTATIONS[1]) @ np.array([0.5 + 4.0, 0.0, 0.5]))
    z2 = 150.0 * x_cam[0] / x_cam[2]
    got = ground_position(float(pixels[0][0]) - 80.0, float(z2), ROOM)
    assert abs(got[1] - 0.5) * 1000 == pytest.approx(off_mm, rel=0.02)


@given(places, places, places, places, rigs)
def test_scaling_factors_are_the_pinholes_ratio_of_heights(
    x_m: float, z_m: float, x0_m: float, z0_m: float, rig: PaperRig
) -> None:
    """P45: a rod of one metre, its height in the picture now over then."""
    r_1, r_2 = scaling_factors((x_m, z_m), (x0_m, z0_m), rig)
    height_now = (
        rig.focal_1_px / (rig.distance_1_m - z_m),
        rig.focal_2_px / (rig.distance_2_m + x_m),
    )
    height_then = (
        rig.focal_1_px / (rig.distance_1_m - z0_m),
        rig.focal_2_px / (rig.distance_2_m + x0_m),
    )
    assert (r_1, r_2) == pytest.approx(
        (height_now[0] / height_then[0], height_now[1] / height_then[1])
    )


@given(places, places, rigs)
def test_eq_4_as_printed_is_the_same_while_the_reference_is_on_the_axis(
    x_m: float, z_m: float, rig: PaperRig
) -> None:
    """M5."""
    assert scaling_factors((x_m, z_m), (0.0, 0.0), rig)[0] == pytest.approx(
        printed_eq_4(x_m, z_m, (0.0, 0.0), rig)
    )


@pytest.mark.parametrize(("x0_m", "off"), [(0.5, -0.008), (1.0, -0.03)])
def test_eq_4_as_printed_is_off_where_its_reference_is_off_the_axis(
    x0_m: float, off: float
) -> None:
    """M5: -0.8 % at half a metre, -3 % at one: why the ratio of depths is used."""
    exact = scaling_factors((x0_m, 0.0), (x0_m, 0.0), ROOM)[0]
    wrong = printed_eq_4(0.3, 0.4, (x0_m, 0.0), ROOM)
    true = scaling_factors((0.3, 0.4), (x0_m, 0.0), ROOM)[0]
    assert exact == 1.0
    assert wrong / true - 1 == pytest.approx(off, abs=0.001)


def test_a_pixel_of_camera_2_moves_the_scale_in_camera_1_by_a_percent_at_most() -> None:
    """P45: 1 px in z2 changes r_t1 by 0.7-1 %."""
    for place in [(0.0, 0.0), (0.5, 0.8), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)]:
        x1, z2 = columns_of(*place, ROOM)
        r = [scaling_factors(ground_position(x1, z2 + d, ROOM), (0, 0), ROOM)[0] for d in (0, 1)]
        assert 0.0065 < r[1] / r[0] - 1 < 0.0106


def aimed(name: str, place: Vector, target: Vector, focal: float) -> Camera:
    """A camera that looks from a place at a target, level, with some distortion."""
    forward = (target - place) / np.linalg.norm(target - place)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    R = np.array([right, np.cross(forward, right), forward])
    K = ((focal, 0.0, 160.0), (0.0, focal, 120.0), (0.0, 0.0, 1.0))
    rows = tuple(tuple(float(n) for n in row) for row in R)
    t = tuple(float(n) for n in -R @ place)
    return Camera(name, K, rows, t, (-0.1, 0.02, 0.001, 0.0, 0.0))  # type: ignore[arg-type]


@given(
    st.floats(-1.0, 1.0),
    st.floats(0.0, 2.0),
    st.floats(-1.0, 1.0),
    st.floats(0.4, 2.6),
    st.floats(0.5, 2.5),
)
def test_triangulation_gives_back_the_point_for_cameras_anywhere(
    x: float, y: float, z: float, apart_rad: float, height: float
) -> None:
    point = np.array([x, y, z])
    cameras = tuple(
        aimed(
            f"c{angle}",
            np.array([5 * math.sin(angle), height, 5 * math.cos(angle)]),
            np.array([0.0, 1.0, 0.0]),
            300.0,
        )
        for angle in (0.2, 0.2 + apart_rad)
    )
    pixels = [project(camera, point[None])[0] for camera in cameras]
    pairs = tuple((float(u), float(v)) for u, v in pixels)
    got = triangulate(cameras, pairs)  # type: ignore[arg-type]
    assert got == pytest.approx(point, abs=1e-4)


@given(places, places, st.floats(0.0, 2.0))
def test_triangulation_is_eq_3_in_the_papers_rig(x_m: float, z_m: float, y_m: float) -> None:
    """P44: two ways to one place."""
    rig = paper_rig((160, 120), (150.0, 180.0), (4.0, 5.0))
    four = as_paper_rig(rig)
    assert four is not None
    (u1, v1), (u2, v2) = (project(one, np.array([[x_m, y_m, z_m]]))[0] for one in rig.cameras)
    got = triangulate(_two(rig), ((float(u1), float(v1)), (float(u2), float(v2))))
    assert (got[0], got[2]) == pytest.approx(
        ground_position(float(u1) - 80.0, float(u2) - 80.0, four), abs=1e-9
    )
    assert got[1] == pytest.approx(y_m, abs=1e-9)


def test_rays_that_miss_meet_halfway() -> None:
    """Camera 1 sees a point 0.2 m higher than camera 2 does: the midpoint is believed."""
    rig = paper_rig((160, 120), (150.0, 150.0), (4.0, 4.0))
    high = project(rig.cameras[0], np.array([[0.0, 1.1, 0.0]]))[0]
    low = project(rig.cameras[1], np.array([[0.0, 0.9, 0.0]]))[0]
    got = triangulate(_two(rig), ((float(high[0]), float(high[1])), (float(low[0]), float(low[1]))))
    assert got[1] == pytest.approx(1.0, abs=1e-6)


def test_parallel_rays_have_no_place() -> None:
    rig = paper_rig((160, 120), (150.0, 150.0), (4.0, 4.0))
    twice = (rig.cameras[0], rig.cameras[0])
    assert np.isnan(triangulate(twice, ((80.0, 60.0), (80.0, 60.0)))).all()


def _two(rig: Rig) -> tuple[Camera, Camera]:
    return rig.cameras[0], rig.cameras[1]
