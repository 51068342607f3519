"""How late a camera is, by how much its pictures change: shifted motion, a gait, none."""

import numpy as np
import pytest

from tritrack.recording_cameras.motion_delay import change, delay_s, small_of


def motion(times_s: np.ndarray, seed: int = 1) -> np.ndarray:
    """Changes of a person who begins and stops at odd moments, as a function of time."""
    random = np.random.default_rng(seed)
    centres, widths = random.uniform(0, 12, 25), random.uniform(0.08, 0.3, 25)
    bursts = np.exp(-(((times_s[:, None] - centres) / widths) ** 2))
    return 0.3 + np.asarray((bursts * random.uniform(0.5, 2.0, 25)).sum(axis=1))


@pytest.mark.parametrize("late_s", [-0.21, 0.0, 0.035, 0.3])
def test_motion_that_is_shown_later_is_found_to_ten_milliseconds(late_s: float) -> None:
    """Cameras of 30 and 25 frames a second, noise and gain of their own."""
    random = np.random.default_rng(5)
    one, other = np.arange(0.0, 12.0, 1 / 30), np.arange(0.013, 12.0, 1 / 25)
    first = motion(one) + random.normal(0, 0.05, len(one))
    second = 2.5 * motion(other - late_s) + random.normal(0, 0.1, len(other))
    found = delay_s((one, first), (other, second))
    assert found == pytest.approx(late_s, abs=0.01)
    assert delay_s((other, second), (one, first)) == pytest.approx(-late_s, abs=0.01)


def test_an_even_gait_other_motion_and_a_short_one_say_nothing() -> None:
    times_s = np.arange(0.0, 12.0, 1 / 30)
    gait = 1.0 + np.sin(2 * np.pi * times_s / 0.4)
    assert delay_s((times_s, gait), (times_s, gait)) is None
    assert delay_s((times_s, motion(times_s)), (times_s, motion(times_s, 2))) is None
    short = times_s[times_s < 3.5]
    assert delay_s((short, motion(short)), (short, motion(short))) is None
    assert delay_s((times_s, 0 * times_s), (times_s, 0 * times_s)) is None


def test_a_change_is_the_mean_difference_of_two_pictures() -> None:
    """Half of the picture brighter by 40 of 255."""
    picture = np.full((240, 320, 3), 50, np.uint8)
    brighter = picture.copy()
    brighter[:120] += 40
    assert change(small_of(picture), small_of(brighter)) == pytest.approx(20.0, abs=1.0)
    assert change(None, small_of(picture)) == 0.0
