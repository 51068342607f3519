"""Poles drawn by what they told of a camera, held against a rig that is known."""

import numpy as np
import pytest
from test_poles import CROWD, SIZE, room, seen

from calibration.paper.drawn_poles import drawn_poles
from calibration.paper.poles import Pole, Poles, camera_by_poles
from common.rig.camera import project


@pytest.mark.parametrize("number", [1, 2])
def test_tops_and_feet_are_where_the_rig_shows_them(number: int) -> None:
    measured = seen(room(), CROWD)
    drawn = drawn_poles(measured, number, camera_by_poles(measured, number))
    for end, height_m in enumerate((2.2, 0.0)):
        places = np.array([(x, height_m, z) for x, z in CROWD])
        assert drawn[:, end] == pytest.approx(project(room().cameras[number - 1], places), abs=1e-5)


@pytest.mark.parametrize("number", [1, 2])
def test_what_the_tops_are_off_is_the_misfit(number: int) -> None:
    measured = seen(room(), CROWD, noise=np.random.default_rng(3))
    known = camera_by_poles(measured, number)
    tops = np.array([getattr(pole, f"cam{number}_px") for pole in measured.poles])
    off_px = tops - drawn_poles(measured, number, known)[:, 0]
    assert np.sqrt(np.mean(off_px**2)) == pytest.approx(known.misfit_px)


def test_a_pole_behind_the_camera_is_not_drawn() -> None:
    measured = seen(room(), CROWD)
    behind = Poles(*SIZE, 2.2, (*measured.poles, Pole(0.0, 9.0)))
    drawn = drawn_poles(behind, 1, camera_by_poles(behind, 1))
    assert np.isnan(drawn[-1]).all()
    assert np.isfinite(drawn[:-1]).all()
