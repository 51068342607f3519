"""Poles, held against rigs that are known and the error bars that the requirements print (P43)."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares

from calibration.paper.poles import (
    READING_SD_PX,
    TAPE_SD_M,
    Pole,
    Poles,
    Quality,
    camera_by_poles,
    poles,
)
from common.rig.camera import Rig, as_paper_rig, paper_rig, project
from common.rig.rig_file import CalibrationError

SIZE = (160, 120)
CORNERS = ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0))
"""A, B and C of section 4.1, with D_X = D_Z = 1 m."""
CROWD = (*CORNERS, (-1.0, 1.0), (1.0, 1.0), (-0.5, -1.0), (1.0, -1.0))


def room(
    focals: tuple[float, float] = (150.0, 170.0),
    distances: tuple[float, float] = (4.0, 4.5),
    heights: tuple[float, float] = (1.0, 0.9),
    size: tuple[int, int] = SIZE,
) -> Rig:
    return paper_rig(size, focals, distances, heights)


def seen(
    rig: Rig,
    places: Sequence[tuple[float, float]],
    height_m: float = 2.2,
    noise: np.random.Generator | None = None,
    taped_m: tuple[float | None, float | None] = (None, None),
) -> Poles:
    """Tops of poles as the rig shows them, read to the pixel where there is a source of noise."""
    tops = np.array([(x, height_m, z) for x, z in places])
    pictures = [project(camera, tops) for camera in rig.cameras]
    if noise is not None:
        pictures = [pixels + noise.uniform(-0.5, 0.5, pixels.shape) for pixels in pictures]
    pixels_1, pixels_2 = (picture.tolist() for picture in pictures)
    return Poles(
        width=rig.width,
        height=rig.height,
        pole_height_m=height_m,
        poles=tuple(
            Pole(x, z, tuple(one), tuple(other))
            for (x, z), one, other in zip(places, pixels_1, pixels_2, strict=True)
        ),
        distance_1_m=taped_m[0],
        distance_2_m=taped_m[1],
    )


def numbers(quality: Quality) -> list[float]:
    return [n for one in quality.cameras for n in (one.focal_px, one.distance_m, one.height_m)]


@given(
    st.tuples(st.floats(80.0, 900.0), st.floats(80.0, 900.0)),
    st.tuples(st.floats(2.5, 9.0), st.floats(2.5, 9.0)),
    st.tuples(st.floats(0.3, 1.8), st.floats(0.3, 1.8)),
    st.sampled_from([CORNERS, CROWD]),
)
def test_a_rig_is_found_exactly_from_points_without_noise(
    focals: tuple[float, float],
    distances: tuple[float, float],
    heights: tuple[float, float],
    places: Sequence[tuple[float, float]],
) -> None:
    """P43, M2: three poles suffice, more agree."""
    rig, quality = poles(seen(room(focals, distances, heights), places))
    wanted = [n for pair in zip(focals, distances, heights, strict=True) for n in pair]
    assert numbers(quality) == pytest.approx(wanted, rel=1e-6)
    assert as_paper_rig(rig) == pytest.approx((*focals, *distances), rel=1e-6)
    assert max(one.misfit_px for one in quality.cameras) < 1e-6


def test_the_three_poles_give_the_papers_formulas() -> None:
    """Section 4.1: lambda1 = Zc1 (x1C - x1A) / D_X (M2), Zc1 = D_Z t1B / (t1B - t1A), on readings
    that fit no rig: A and C are equally high, B is a pixel off."""
    a, b, c = (83.0, 20.0), (83.0, 9.0), (120.0, 20.0)
    read = tuple(
        Pole(x, z, own, other)
        for (x, z), own, other in zip(
            CORNERS, (a, b, c), ((80.0, 20.0), (120.0, 20.0), (80.0, 28.0)), strict=True
        )
    )
    _, quality = poles(Poles(160, 120, 2.2, read))
    t_a, t_b = 60.0 - 20.0, 60.0 - 9.0
    distance = 1.0 * t_b / (t_b - t_a)
    first, second = quality.cameras
    assert first.distance_m == pytest.approx(distance)
    assert first.focal_px == pytest.approx(distance * (120.0 - 83.0) / 1.0)
    assert first.off_centre_px == pytest.approx(3.0)
    assert second.distance_m == pytest.approx(1.0 * 32.0 / (40.0 - 32.0))
    assert second.focal_px == pytest.approx(second.distance_m * 40.0 / 1.0)


@pytest.mark.parametrize(
    ("top_m", "apart_m", "bounds_m"), [(0.8, 0.5, (3.3, 5.1)), (1.2, 1.0, (3.8, 4.2))]
)
def test_a_pixel_spoils_the_distance_by_what_the_requirements_say(
    top_m: float, apart_m: float, bounds_m: tuple[float, float]
) -> None:
    """P43's trap, for a true 4 m and lambda = 150 px: t1B read one pixel high or low."""
    places = ((0.0, 0.0), (0.0, apart_m), (apart_m, 0.0))
    measured = seen(room((150.0, 150.0), (4.0, 4.0), (1.0, 1.0)), places, 1.0 + top_m)
    got = []
    for off_px in (-1.0, 1.0):
        first, second, third = measured.poles
        assert second.cam1_px is not None
        column, row = second.cam1_px
        moved = Pole(second.x_m, second.z_m, (column, row + off_px), second.cam2_px)
        _, quality = poles(Poles(160, 120, 1.0 + top_m, (first, moved, third), None, None))
        got.append(quality.cameras[0].distance_m)
    assert sorted(got) == pytest.approx(bounds_m, abs=0.06)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "focals", "places", "taped"),
    [
        ((160, 120), (150.0, 170.0), CROWD, False),
        ((640, 480), (600.0, 680.0), CORNERS, False),
        ((160, 120), (150.0, 170.0), CORNERS, True),
    ],
    ids=["seven poles, 160x120", "three poles, 640x480", "three poles and a tape, 160x120"],
)
def test_the_error_bar_is_the_spread_that_readings_to_the_pixel_have(
    size: tuple[int, int],
    focals: tuple[float, float],
    places: Sequence[tuple[float, float]],
    taped: bool,
) -> None:
    """P43: Monte-Carlo over +-0.5 px (and a tape read to 1 cm) gives the printed bar."""
    random = np.random.default_rng(43)
    rig = room(focals, size=size)
    runs = []
    for _ in range(400):
        tape = (
            (4.0 + random.normal(0, 0.01), 4.5 + random.normal(0, 0.01)) if taped else (None, None)
        )
        runs.append(poles(seen(rig, places, 2.2, random, tape))[1])
    for n in (0, 1):
        bars = runs[0].cameras[n]
        spread_m = np.std([run.cameras[n].distance_m for run in runs])
        spread_px = np.std([run.cameras[n].focal_px for run in runs])
        mean_bar_m = np.mean([run.cameras[n].distance_sd_m for run in runs])
        mean_bar_px = np.mean([run.cameras[n].focal_sd_px for run in runs])
        assert mean_bar_m == pytest.approx(spread_m, rel=0.12), bars
        assert mean_bar_px == pytest.approx(spread_px, rel=0.12), bars


def test_a_tape_is_worth_more_than_poles_in_a_small_picture() -> None:
    """P43: prefer a measured distance."""
    noise = np.random.default_rng(1)
    rig = room()
    by_poles = poles(seen(rig, CORNERS, 2.2, noise))[1].cameras[0]
    by_tape = poles(seen(rig, CORNERS, 2.2, noise, (4.0, 4.5)))[1].cameras[0]
    assert by_tape.distance_sd_m <= 0.01 < by_poles.distance_sd_m / 5
    assert by_tape.focal_sd_px < by_poles.focal_sd_px
    assert by_tape.distance_m == pytest.approx(4.0, abs=0.02)


def test_tops_read_to_the_pixel_misfit_by_a_third_of_one() -> None:
    """The standard deviation of +-0.5 px is 0.289; a wrong place of a pole shows as far more."""
    noise = np.random.default_rng(2)
    measured = seen(room(), CROWD, 2.2, noise)
    assert 0.15 < poles(measured)[1].cameras[0].misfit_px < 0.4
    first, *others = measured.poles
    misplaced = Pole(first.x_m + 0.1, first.z_m, first.cam1_px, first.cam2_px)
    wrong = Poles(160, 120, 2.2, (misplaced, *others))
    assert poles(wrong)[1].cameras[0].misfit_px > 0.6


def test_a_pole_that_one_camera_does_not_show_still_serves_the_other() -> None:
    measured = seen(room(), CROWD)
    hidden = tuple(
        Pole(p.x_m, p.z_m, p.cam1_px, None if n == 4 else p.cam2_px)
        for n, p in enumerate(measured.poles)
    )
    _, quality = poles(Poles(160, 120, 2.2, hidden))
    assert numbers(quality) == pytest.approx([150.0, 4.0, 1.0, 170.0, 4.5, 0.9], rel=1e-6)


@pytest.mark.parametrize(
    ("places", "height_m", "taped_m", "says"),
    [
        (CORNERS[:1], 2.2, (None, None), "cam1 shows 1 poles"),
        ([(0.0, 0.0), (1.0, 0.0)], 2.2, (None, 4.5), "do not show how far cam1 stands"),
        ([(0.0, 0.0), (0.0, 1.0)], 2.2, (4.0, None), "no pole stands off the axis of cam1"),
        (CORNERS, 1.0, (None, None), "cam1"),
        (CORNERS, 2.2, (0.5, None), "do not show how far cam1 stands"),
    ],
    ids=["one pole", "all equally far", "all on the axis", "tops at the lens", "pole behind lens"],
)
def test_poles_that_leave_something_open_are_refused_with_the_cure(
    places: Sequence[tuple[float, float]],
    height_m: float,
    taped_m: tuple[float | None, float | None],
    says: str,
) -> None:
    measured = seen(room(heights=(1.0, 1.0)), places, height_m, taped_m=taped_m)
    with pytest.raises(CalibrationError, match=says):
        poles(measured)


def test_a_pole_height_that_puts_a_lens_below_the_floor_is_refused() -> None:
    measured = seen(room(), CORNERS)
    low = Poles(160, 120, 1.0, measured.poles)
    with pytest.raises(CalibrationError, match="check pole_height_m"):
        poles(low)


def test_a_pole_at_the_lens_itself_is_refused() -> None:
    """It was a fault: numbers overflowed on the way to the same refusal."""
    near = 2.2250738585072014e-308
    measured = Poles(160, 120, 1.0, (Pole(near, 0.0, None, (1.0, 1.0)),) * 2, None, 1e-200)
    with pytest.raises(CalibrationError, match="do not show how far cam2 stands"):
        camera_by_poles(measured, 2)


def refitted(measured: Poles, number: int) -> np.ndarray:
    """Distance, focal length, rise and off-centre that make the weighted squares least, by a solver
    that knows nothing of ours."""
    half = (measured.width / 2, measured.height / 2)
    taped_m = measured.distance_1_m if number == 1 else measured.distance_2_m

    def off(values: np.ndarray) -> np.ndarray:
        distance_m, focal_px, rise, off_centre_px = values
        found = []
        for pole in measured.poles:
            across, towards = (pole.x_m, pole.z_m) if number == 1 else (pole.z_m, -pole.x_m)
            pixel = pole.cam1_px if number == 1 else pole.cam2_px
            if pixel is not None:
                deep_m = distance_m - towards
                found.append(pixel[0] - half[0] - focal_px * across / deep_m - off_centre_px)
                found.append(half[1] - pixel[1] - rise / deep_m)
        if taped_m is not None:
            found.append((taped_m - distance_m) * READING_SD_PX / TAPE_SD_M)
        return np.array(found)

    start = (taped_m or 4.0, 150.0, 180.0, 0.0)
    return np.asarray(least_squares(off, start, xtol=1e-14, ftol=1e-14, gtol=1e-14).x)


@pytest.mark.parametrize("taped_m", [(None, None), (4.03, 4.44)], ids=["poles", "and a tape"])
def test_the_rig_is_that_of_the_least_weighted_squares(
    taped_m: tuple[float | None, float | None],
) -> None:
    """Each camera by its own readings and its own tape, which say different things."""
    noise = np.random.default_rng(8)
    measured = seen(room(size=(640, 480)), CROWD, 2.2, noise, taped_m)
    for number, camera in enumerate(poles(measured)[1].cameras, 1):
        distance_m, focal_px, rise, off_centre_px = refitted(measured, number)
        assert camera.name == f"cam{number}"
        assert camera.distance_m == pytest.approx(distance_m, rel=1e-6)
        assert camera.focal_px == pytest.approx(focal_px, rel=1e-6)
        assert camera.height_m == pytest.approx(2.2 - rise / focal_px, rel=1e-6)
        assert camera.off_centre_px == pytest.approx(off_centre_px, abs=1e-4)


def test_readings_that_fit_no_rig_are_off_by_their_root_mean_square() -> None:
    """Of columns and rows alone: a tape that lies is no misfit of the tops."""
    measured = seen(room(), CROWD, taped_m=(4.2, None))
    camera = camera_by_poles(measured, 1)
    off = []
    for pole in measured.poles:
        assert pole.cam1_px is not None
        deep_m = camera.distance_m - pole.z_m
        column = camera.focal_px * pole.x_m / deep_m + camera.off_centre_px
        row = camera.focal_px * (2.2 - camera.height_m) / deep_m
        off += [pole.cam1_px[0] - 80.0 - column, 60.0 - pole.cam1_px[1] - row]
    assert camera.misfit_px == pytest.approx(np.sqrt(np.mean(np.square(off))), rel=1e-6)
    assert camera.misfit_px > 0.05
