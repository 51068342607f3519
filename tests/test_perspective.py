"""Place and scale, held against the pinhole and against the paper's printed equations (4.2)."""

import math
from typing import Final

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.body.body import Elliptic, Vector
from common.body.proportions import thesis_bdp
from common.bus.messages import Measure
from common.rig.camera import (
    PAPER_ROTATIONS,
    Camera,
    PaperRig,
    Rig,
    as_paper_rig,
    paper_rig,
    project,
)
from integrator.rig.perspective import (
    ground_position,
    px_per_m,
    scaling_factors,
    triangulate,
    universal_bdp,
)

ROOM: Final = PaperRig(150.0, 150.0, 4.0, 4.0)
"""The rig that the requirements' figures are for: 37 px to a metre at 4 m."""

places = st.floats(-2.0, 2.0)
focals = st.floats(50.0, 2000.0)
distances = st.floats(2.5, 12.0)
rigs = st.builds(PaperRig, focals, focals, distances, distances)


def seen(x_m: float, z_m: float, rig: PaperRig) -> tuple[float, float]:
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
    x1d, x1a = seen(x, z, rig)[0], seen(*a, rig)[0]
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
    x1, z2 = seen(x_m, z_m, rig)
    if min(abs(x1), abs(z2)) > 1e-3:
        assert ground_position(x1, z2, rig) == pytest.approx(printed_eq_3(x1, z2, rig), abs=1e-9)


@given(rigs, places)
def test_points_on_the_axes_are_finite(rig: PaperRig, m: float) -> None:
    """M4: the printed form is 0/0 at the calibrated start."""
    assert ground_position(0.0, 0.0, rig) == (0.0, 0.0)
    assert ground_position(*seen(m, 0.0, rig), rig) == pytest.approx((m, 0.0), abs=1e-9)
    assert ground_position(*seen(0.0, m, rig), rig) == pytest.approx((0.0, m), abs=1e-9)


def test_leaving_eq_3_out_costs_what_the_requirements_say() -> None:
    """P44: X = x Zc1 / lambda1 is 125 mm off at (0.5, 0.8); a pixel is 27 mm at 4 m."""
    x1, z2 = seen(0.5, 0.8, ROOM)
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
        x1, z2 = seen(*place, ROOM)
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


def test_a_metre_is_the_focal_length_over_the_depth() -> None:
    rig = paper_rig((160, 120), (150.0, 180.0), (4.0, 5.0))
    assert px_per_m(rig.cameras[0], np.array([0.3, 1.0, 1.0])) == pytest.approx(150.0 / 3.0)
    assert px_per_m(rig.cameras[1], np.array([1.0, 1.0, 0.3])) == pytest.approx(180.0 / 6.0)
    assert math.isnan(px_per_m(rig.cameras[0], np.array([0.0, 1.0, 4.5])))


@pytest.mark.parametrize("distance_2_m", [4.0, 2.0, 7.0])
def test_the_same_person_has_the_same_bdps_wherever_camera_2_stands(distance_2_m: float) -> None:
    """P46: camera 2 at half the distance, whole pixels read: depth within a pixel."""
    truth = thesis_bdp(1.75)
    scale_1, scale_2 = 150.0 / 4.0, 150.0 / distance_2_m
    first = truth.scaled(scale_1)
    unknown = msgspec.structs.replace(first.torso, short_radius=9.9)
    front = Measure(
        height_px=round(1.75 * scale_1),
        centre_px=(80.0, 60.0),
        depth_px=first.torso.long_radius,
        bdp_px=msgspec.structs.replace(first, torso=unknown),
    )
    side = Measure(
        height_px=round(1.75 * scale_2),
        centre_px=(80.0, 60.0),
        depth_px=round(2 * truth.torso.short_radius * scale_2) / 2,
    )
    got = universal_bdp(front, side, scale_1)
    assert np.array(got.lengths()) == pytest.approx(np.array(truth.lengths()), abs=1 / scale_1)
    assert isinstance(got.torso, Elliptic)
    assert got.torso.short_radius != pytest.approx(9.9 / scale_1)


def test_bdps_without_a_facade_are_refused() -> None:
    side = Measure(height_px=66.0, centre_px=(80.0, 60.0), depth_px=5.0)
    with pytest.raises(ValueError, match="did not see the facade"):
        universal_bdp(side, side, 37.5)


def _two(rig: Rig) -> tuple[Camera, Camera]:
    return rig.cameras[0], rig.cameras[1]
