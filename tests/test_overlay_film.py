"""The overlay's film lasts as long as the one that was followed, whatever that one's rate does;
the body beside it stands as it stood."""

import numpy as np
import pytest

from common.rig.camera import Camera, Matrix
from tritrack.offline.film_tracking import Followed
from tritrack.single.overlay_film import STANDS_S, shown_times


@pytest.mark.parametrize("rate_hz", [15.0, 24_000 / 1001, 25.0, 30.0, 59.94])
def test_each_picture_of_a_steady_film_is_shown_once(rate_hz: float) -> None:
    time_s = np.arange(2000) / rate_hz
    assert (shown_times(time_s, 1 / rate_hz) == 1).all()


def test_a_picture_stands_until_the_next_was_taken() -> None:
    """By hand, at ten a second: the second picture stands for 0.3 s, the third is left out."""
    assert shown_times(np.array([0.0, 0.1, 0.4, 0.41, 0.5]), 0.1).tolist() == [1, 3, 0, 1, 1]


def test_a_film_whose_rate_varies_keeps_its_duration() -> None:
    gaps_s = np.random.default_rng(3).choice([1, 1, 1, 2, 4], 500) / 30
    time_s = np.concatenate([[0.0], np.cumsum(gaps_s)])
    assert shown_times(time_s, 1 / 30).sum() == pytest.approx(30 * time_s[-1] + 1)


def test_an_hour_without_a_picture_is_not_drawn() -> None:
    assert shown_times(np.array([0.0, 0.1, 3600.0]), 0.1).tolist() == [1, round(STANDS_S * 10), 1]


def test_one_frame_is_a_film() -> None:
    assert shown_times(np.array([2.5]), 0.1).tolist() == [1]


SINE, COSINE = 0.6, 0.8
DOWN: Matrix = ((1.0, 0.0, 0.0), (0.0, -COSINE, SINE), (0.0, -SINE, -COSINE))
"""World to a camera on +z that looks down by 37 degrees."""
ASIDE: Matrix = ((0.0, 0.0, -1.0), (-SINE, -COSINE, 0.0), (-COSINE, SINE, 0.0))
"""To one on +x that looks up so far."""


@pytest.mark.parametrize(("R", "towards"), [(DOWN, (0.0, 0.0, 1.0)), (ASIDE, (1.0, 0.0, 0.0))])
def test_who_stands_upright_before_a_camera_that_looks_down_or_up_is_drawn_upright(
    R: Matrix, towards: tuple[float, float, float]
) -> None:
    assert np.linalg.det(np.array(R)) == pytest.approx(1.0)
    camera = Camera("cam1", DOWN, R, (0.0, 0.0, 5.0))
    film = Followed([], [], 1 / 15, camera, None, None, {})
    shown = film.to_camera(np.array([(0.0, 0.0, 0.0), (0.0, 1.7, 0.0), towards]))
    assert shown == pytest.approx(np.array([(0, 0, 0), (0, 1.7, 0), (0, 0, 1)]), abs=1e-12)
