"""Triangulated points, held against points that are known and against drawn errors."""

import numpy as np
import pytest

from calibration.tracks.rig_guess import Pinhole, rotation
from calibration.tracks.sight_lines import Meeting, directions, meeting

CAMERAS = (
    Pinhole(200.0, rotation(0.0, 0.1, 0.02), np.array([0.0, 1.0, 4.0])),
    Pinhole(240.0, rotation(-1.2, -0.1, 0.0), np.array([-3.6, 1.4, 1.2])),
)
MIDDLE = np.array([80.0, 60.0])


def shown(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pictures = []
    for camera in CAMERAS:
        seen = (points - camera.centre_m) @ camera.R.T
        pictures.append(camera.focal_px * seen[..., :2] / seen[..., 2:] + MIDDLE)
    return pictures[0], pictures[1]


def met(pictures: tuple[np.ndarray, np.ndarray], sigmas_px: tuple[float, float]) -> Meeting:
    first, second = (
        directions(camera, MIDDLE, pixels) for camera, pixels in zip(CAMERAS, pictures, strict=True)
    )
    spreads = tuple(np.full(first.shape[:-1], sigma) for sigma in sigmas_px)
    return meeting(CAMERAS, (first, second), (spreads[0], spreads[1]))


def test_exact_pixels_give_the_points_themselves() -> None:
    points = np.random.default_rng(1).uniform((-0.8, 0.0, -0.8), (0.8, 1.8, 0.8), (5, 15, 3))
    found = met(shown(points), (0.5, 0.5))
    assert found.points_m == pytest.approx(points, abs=1e-9)
    assert np.abs(found.gap).max() < 1e-6
    assert found.before.all()


def test_errors_are_as_large_as_the_variances_say() -> None:
    """Drawn 20,000 times: along three directions, and of the gap, within 5 %."""
    rng, n = np.random.default_rng(2), 20_000
    point = np.broadcast_to([0.2, 1.1, -0.3], (n, 1, 3))
    sigmas_px = (0.8, 1.7)
    spoiled = [p + rng.normal(0, s, p.shape) for p, s in zip(shown(point), sigmas_px, strict=True)]
    found = met((spoiled[0], spoiled[1]), sigmas_px)
    assert found.gap.std() == pytest.approx(1.0, rel=0.05)
    for axis in np.eye(3):
        said = found.variance_m2(np.broadcast_to(axis, point.shape)).mean()
        drawn = (found.points_m @ axis).var()
        assert drawn == pytest.approx(said, rel=0.05)


@pytest.mark.parametrize("place_m", [(0.5, 1.2, 1.9), (1.5, 0.9, -5.0)], ids=["near", "far"])
def test_errors_of_the_same_pixels_miss_by_as_many_sigmas_near_and_far(
    place_m: tuple[float, float, float],
) -> None:
    """Taken as so many metres anywhere they do not, and focal lengths come out too short."""
    rng = np.random.default_rng(3)
    points = np.broadcast_to(place_m, (20_000, 1, 3))
    spoiled = [pixels + rng.normal(0, 0.8, pixels.shape) for pixels in shown(points)]
    assert met((spoiled[0], spoiled[1]), (0.8, 0.8)).gap.std() == pytest.approx(1.0, rel=0.05)
