"""Vectors that are rigs, held against the paper's rig (C1)."""

import math

import numpy as np
import pytest

from calibration.tracks.person_prior import SHARES
from calibration.tracks.rig_guess import FOCALS, RIG, pinholes, rig_of, rotation
from common.rig.camera import PAPER_ROTATIONS, paper_rig


def test_the_papers_rig_is_a_vector_whose_second_camera_is_turned_to_the_right() -> None:
    focals = (200.0, 210.0)
    told = [*np.log(focals), 0, 0, 1.0, -math.pi / 2, 0, 0, -4.5, 0.9, -4.0, *np.log(SHARES), 0]
    found = rig_of(pinholes(np.array(told)), (160, 120), np.array([0.0, 0.0, -4.0]))
    wanted = paper_rig((160, 120), focals, (4.0, 4.5), (1.0, 0.9))
    for one, other in zip(found.cameras, wanted.cameras, strict=True):
        assert np.array(one.K) == pytest.approx(np.array(other.K))
        assert np.array(one.R) == pytest.approx(np.array(other.R), abs=1e-12)
        assert one.t == pytest.approx(other.t, abs=1e-12)


@pytest.mark.parametrize(
    ("turn", "sight"),
    [((0.3, 0.0, 0.0), (-math.sin(0.3), 0.0)), ((0.0, 0.3, 0.0), (0.0, math.sin(0.3)))],
    ids=["yaw to the left", "pitch upwards"],
)
def test_a_turned_camera_looks_where_it_is_turned_to(
    turn: tuple[float, float, float], sight: tuple[float, float]
) -> None:
    assert rotation(*turn)[2, :2] == pytest.approx(sight)


def test_a_camera_that_is_rolled_clockwise_shows_the_right_hand_higher() -> None:
    level = np.array(PAPER_ROTATIONS[0])
    aside = rotation(0.0, 0.0, 0.1) @ [1.0, 0.0, 0.0]
    assert (level @ [1.0, 0.0, 0.0])[1] == 0.0
    assert aside[1] < 0.0


def test_a_step_of_the_fit_that_flies_off_gives_cameras_that_can_be_reckoned_with() -> None:
    """It is taken back then; e^800 would be no number."""
    guess = np.zeros(RIG + len(SHARES) + 1)
    guess[FOCALS] = (800.0, -800.0)
    focals = [camera.focal_px for camera in pinholes(guess)]
    assert np.isfinite(focals).all()
    assert focals[0] > 1e6
    assert 0.0 < focals[1] < 1e-6
