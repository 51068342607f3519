"""A camera that hangs, told by people who walk before it, held against the camera that saw them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from staging import observation

from common.body.observation import Box
from common.rig.camera import Camera, arrays_of, as_matrix, as_row, centre, project
from integrator.proposal.silhouette_window import standing_m
from integrator.rig.assumed_rig import FOCAL_SHARE
from integrator.rig.tilted_camera import assumed_rig_of_one, camera_of_sights

SIZE = (320, 240)
STATURE_M = 1.75


def hung(tilt_deg: float, height_m: float) -> Camera:
    """A camera at (0, height, 5) that looks along -z and down."""
    tilt, focal = np.radians(tilt_deg), FOCAL_SHARE * SIZE[0]
    sine, cosine = np.sin(tilt), np.cos(tilt)
    R = np.array([[1, 0, 0], [0, -cosine, sine], [0, -sine, -cosine]])
    K = ((focal, 0.0, SIZE[0] / 2), (0.0, focal, SIZE[1] / 2), (0.0, 0.0, 1.0))
    return Camera("cam1", K, as_matrix(R), as_row(-R @ np.array([0.0, height_m, 5.0])))


def sights(camera: Camera, towards_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of crown and soles of somebody upright at places along z."""
    rows = [
        project(camera, np.array([[0.0, STATURE_M, z], [0.0, 0.0, z]]))[:, 1] for z in towards_m
    ]
    return np.array(rows)


def tilt_deg(camera: Camera) -> float:
    return float(np.degrees(np.arcsin(-arrays_of(camera).R[2, 1])))


@pytest.mark.parametrize(("tilt", "height_m"), [(0, 1.2), (10, 1.6), (20, 2.5), (32, 3.0)])
def test_a_walk_along_the_floor_tells_how_far_a_camera_looks_down(
    tilt: int, height_m: float
) -> None:
    found = camera_of_sights(
        SIZE, sights(hung(tilt, height_m), np.linspace(-1.5, 1.5, 60)), STATURE_M
    )
    assert tilt_deg(found) == pytest.approx(tilt, abs=3.0)
    assert centre(found)[1] == pytest.approx(height_m, rel=0.1)


def test_who_bends_lies_or_sits_in_a_third_of_the_film_does_not_mislead_it() -> None:
    seen = sights(hung(20, 2.5), np.linspace(-1.5, 1.5, 60))
    seen[::3, 0] = seen[::3, 1] - 0.4 * (seen[::3, 1] - seen[::3, 0])
    assert tilt_deg(camera_of_sights(SIZE, seen, STATURE_M)) == pytest.approx(20, abs=3.0)


def test_who_stands_at_one_place_leaves_the_camera_level_and_is_as_tall_as_assumed() -> None:
    """T20: what the thesis takes for granted, where nothing speaks against it."""
    seen = sights(hung(0, 1.2), np.zeros(40))
    found = camera_of_sights(SIZE, seen, STATURE_M)
    assert tilt_deg(found) == pytest.approx(0.0, abs=0.5)
    shown = project(found, np.array([[0.0, STATURE_M, 0.0], [0.0, 0.0, 0.0]]))
    assert shown[:, 1] == pytest.approx(seen[0], abs=3.0)


def test_feet_that_rise_with_each_step_are_no_walk_towards_a_camera() -> None:
    """Of who crosses the picture; their crown stays where it is, which would be a steep camera."""
    seen = sights(hung(0, 1.2), np.zeros(60))
    seen[:, 1] -= 0.08 * (seen[0, 1] - seen[0, 0]) * np.abs(np.sin(np.arange(60) / 3))
    assert abs(tilt_deg(camera_of_sights(SIZE, seen, STATURE_M))) <= 6.0


def test_whose_feet_are_above_the_middle_is_seen_by_a_camera_that_looks_down() -> None:
    """A level one would have its floor over itself."""
    found = camera_of_sights(SIZE, np.array([[20.0, 90.0]]), STATURE_M)
    assert tilt_deg(found) > 5.0
    assert centre(found)[1] > 0.5


@given(st.lists(st.tuples(st.floats(0, 239), st.floats(1, 240)), min_size=1, max_size=20))
def test_whatever_was_seen_there_is_a_camera_before_it_above_the_floor(
    rows: list[tuple[float, float]],
) -> None:
    seen = np.array([(crown, max(sole, crown + 1.0)) for crown, sole in rows])
    found = camera_of_sights(SIZE, seen, STATURE_M)
    assert np.isfinite(centre(found)).all()
    assert centre(found)[1] > 0.0
    assert 0.0 < centre(found)[2] < 12.001


def test_a_live_run_of_one_view_begins_with_a_camera_above_the_floor() -> None:
    """Who comes in far away, below a camera under the ceiling, stood 1 m before it."""
    seen = observation(box=Box(70, 80, 5, 40))
    camera = assumed_rig_of_one(seen, STATURE_M).cameras[0]
    assert centre(camera)[1] > 0.5
    mask = np.zeros((120, 160), np.bool_)
    mask[5:41, 70:80] = True
    assert standing_m(mask, camera)[2] == pytest.approx(0.0, abs=1.0)
    assert centre(camera)[2] > 4.0
