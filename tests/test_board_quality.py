"""How good a board's calibration is said to be, counted by hand."""

import numpy as np
import pytest

from calibration.board.board_fit import Fit, Sight
from calibration.board.board_floor import Floor
from calibration.board.board_quality import miss_px_of, quality_of
from calibration.board.lens_start import Place
from calibration.board.still_board import Moments

SIZE = (96, 48)
STILL = Place(np.zeros(3), np.zeros(3))


def test_every_camera_is_told_by_its_own_corners_and_the_rig_by_all() -> None:
    """Camera 1 sees the left half in three rests, 3 px off; camera 2 all in one, 4 px off."""
    px = np.full((3, 2, 4, 2), np.nan)
    px[:, 0] = [(0.0, 0.0), (47.0, 0.0), (47.0, 47.0), (0.0, 47.0)]
    px[2, 1] = [(0.0, 0.0), (95.0, 0.0), (95.0, 47.0), (0.0, 47.0)]
    moments = Moments(np.array([0.5, 2.0, 7.0]), np.array([1.0, 3.0, 9.0]), px)
    sights, misses = [], []
    for camera, rest, off in ((0, 0, (3.0, 0.0)), (0, 1, (0.0, 3.0)), (1, 2, (4.0, 0.0))):
        sights.append(Sight(camera, rest, np.zeros((4, 3)), px[rest, camera]))
        misses.append(np.tile(off, (4, 1)))
    lenses = np.array([[400.0, 401.0, 48, 24, 0.1, -0.2], [500.0, 501.0, 48, 24, 0.3, -0.4]])
    fit = Fit(lenses, (STILL, STILL), (STILL,) * 3, np.array([1.5, 2.5]), tuple(misses))
    told = quality_of(fit, sights, moments, Floor(np.ones(3), np.zeros(3), (0, 1)), SIZE)
    first, second = told.cameras
    assert (first.name, first.focal_px, first.focal_error_px) == ("cam1", 400.0, 1.5)
    assert (second.name, second.focal_px, second.focal_error_px) == ("cam2", 500.0, 2.5)
    assert (first.k1, first.k2, second.k1, second.k2) == (0.1, -0.2, 0.3, -0.4)
    assert (first.reprojection_px, second.reprojection_px) == pytest.approx((3.0, 4.0))
    assert (first.rests, second.rests) == (3, 1)
    assert (first.coverage, second.coverage) == pytest.approx((0.5, 1.0), abs=0.03)
    assert told.reprojection_px == pytest.approx(np.sqrt((2 * 9 + 16) / 3))
    assert (told.shared_rests, told.floor_s, told.floor_rests) == (1, 2.0, 2)
    assert miss_px_of(fit, sights, 1) == pytest.approx(4.0)
