"""What a camera shows after a turn, held against OpenCV's projection and rotations by hand."""

import cv2
import numpy as np
import pytest

from common.rig.camera import Camera, paper_rig, project
from viewer.background.background import estimated
from viewer.background.turned_picture import (
    lens_of,
    rays_of,
    seen_at,
    turn_between,
    turned_background,
)

SIZE = (64, 48)


def about(*degrees: float) -> np.ndarray:
    return np.asarray(cv2.Rodrigues(np.radians(degrees))[0])


def test_a_camera_without_a_calibration_has_a_usual_lens_that_looks_from_the_middle() -> None:
    lens = lens_of(None, SIZE)
    assert lens.focal_px.tolist() == [80.0, 80.0]
    assert lens.K.tolist() == [[80.0, 0.0, 31.5], [0.0, 80.0, 23.5], [0.0, 0.0, 1.0]]
    assert rays_of(lens, np.array([[31.5, 23.5]])) == pytest.approx(np.array([[0.0, 0.0, 1.0]]))
    assert lens.distortion.tolist() == [0.0] * 4


@pytest.mark.parametrize("distortion", [None, (-0.2, 0.05, 0.0, 0.0, 0.0)])
def test_a_ray_is_where_the_camera_projects_it(distortion: tuple[float, ...] | None) -> None:
    """Its own pixels have the middle of the first at 0, a Camera's at 0.5."""
    plain = paper_rig(SIZE, (90.0, 90.0), (4.0, 4.0)).cameras[0]
    camera = Camera(plain.name, plain.K, plain.R, plain.t, distortion or ())
    lens = lens_of(camera, SIZE)
    assert (np.array(camera.K) - lens.K).tolist() == [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]]
    places = np.array([[3.0, 5.0], [40.0, 30.0], [60.0, 44.0]])
    rays = rays_of(lens, places)
    assert np.linalg.norm(rays, axis=1) == pytest.approx([1.0] * 3)
    world = -np.array(camera.R).T @ np.array(camera.t) + 3.0 * rays @ np.array(camera.R)
    assert project(camera, world) - 0.5 == pytest.approx(places, abs=1e-3)
    assert seen_at(lens, np.eye(3), places) == pytest.approx(places, abs=1e-3)


def test_what_a_turn_to_the_right_shows_moves_by_the_focal_length_times_its_tangent() -> None:
    lens = lens_of(None, SIZE)
    found = seen_at(lens, about(0.0, 5.0, 0.0), np.array([[31.5, 23.5]]))
    assert found[0] == pytest.approx([31.5 + 80.0 * np.tan(np.radians(5.0)), 23.5])


def test_a_turn_is_found_though_a_third_of_the_rays_went_elsewhere() -> None:
    rng = np.random.default_rng(2)
    before = rng.normal((0.0, 0.0, 1.0), 0.3, (60, 3))
    before /= np.linalg.norm(before, axis=1, keepdims=True)
    turn = about(2.0, -4.0, 1.0)
    after = before @ turn.T
    assert turn_between(before, after, 1e-3) == pytest.approx(turn, abs=1e-9)
    after[:20] = after[:20] @ about(0.0, 12.0, 0.0).T
    found = turn_between(before, after, 1e-3)
    assert np.degrees(np.linalg.norm(cv2.Rodrigues(found @ turn.T)[0])) < 0.05
    assert np.linalg.det(found) == pytest.approx(1.0)
    flat = before * [1.0, 1.0, 0.0]
    assert np.linalg.det(turn_between(flat, flat * [-1.0, 1.0, 1.0], 1e-3)) == pytest.approx(1.0)


def test_a_background_turns_with_its_camera_and_its_rim_is_as_the_frame_has_it() -> None:
    """By 5 degrees about the vertical: what was at column x is 7 px further; the rest is new."""
    lens = lens_of(None, SIZE)
    wide, high = SIZE
    ramp = np.broadcast_to(2.0 * np.arange(wide, dtype=np.float32)[None, :, None], (high, wide, 3))
    spread = np.full((high, wide, 2), (1.0, 2.5), np.float32)
    uncertain = np.zeros((high, wide), bool)
    uncertain[:, 30] = True
    first = estimated(np.array(ramp), spread, uncertain)._replace(
        high=ramp + np.float32(9.0), step=ramp + np.float32(3.0)
    )
    frame = np.full((high, wide, 3), 200, np.uint8)
    turn = about(0.0, 5.0, 0.0)
    now = turned_background(first, lens, turn, frame)
    came_from = seen_at(lens, turn.T, np.array([[40.0, 23.5]]))[0, 0]
    assert came_from == pytest.approx(33.0, abs=0.2)
    assert now.centre[23, 40] == pytest.approx([2.0 * came_from] * 3, abs=0.2)
    assert now.high[23, 40] - now.centre[23, 40] == pytest.approx([9.0] * 3, abs=0.01)
    assert now.low[23, 40] == pytest.approx(now.centre[23, 40], abs=0.01)
    assert now.step[23, 40] - now.centre[23, 40] == pytest.approx([3.0] * 3, abs=0.01)
    assert (now.centre[:, :6] == 200.0).all()
    assert (now.high[:, :6] == 200.0).all()
    assert now.uncertain[:, :6].all()
    assert now.uncertain[:, 36:39].any()
    assert not now.uncertain[5:43, 42:].any()
    slope = (now.centre[23, 41] - now.centre[23, 39])[0] / 2
    steep = 0.35 * slope
    assert now.spread[23, 40] == pytest.approx(
        [np.hypot(1.0, steep), np.hypot(2.5, steep)], rel=0.02
    )
