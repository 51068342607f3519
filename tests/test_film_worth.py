"""What a film counts, held against errors that are known to last."""

import numpy as np
import pytest

from integrator.selfcalibration.film_worth import LEAST, measured_worth
from integrator.selfcalibration.rig_residuals import Explained
from integrator.selfcalibration.sight_lines import Meeting, Numbers


def film_of(gaps: Numbers) -> Explained:
    all_of_them = np.ones(gaps.shape, bool)
    points, axes = np.zeros((*gaps.shape, 3)), np.zeros((3, *gaps.shape, 3))
    met = Meeting(points, axes, np.ones((3, *gaps.shape)), gaps, gaps, all_of_them)
    return Explained(met, all_of_them, gaps, all_of_them, None)  # type: ignore[arg-type]


def fresh(moments: int) -> Numbers:
    """Of many joints, so that their means are sure."""
    return np.random.default_rng(1).normal(0, 1, (moments, 3000))


def test_twice_as_many_moments_that_err_anew_count_twice() -> None:
    once, twice = (measured_worth([film_of(fresh(n))]) for n in (600, 1200))
    assert twice == pytest.approx(2 * once, rel=0.1)


def test_errors_that_last_ten_moments_count_a_tenth() -> None:
    lasting = np.repeat(fresh(30), 10, axis=0)
    assert measured_worth([film_of(lasting)]) == pytest.approx(measured_worth([film_of(fresh(30))]))


def test_a_film_of_as_many_moments_as_numbers_are_fitted_counts_half() -> None:
    assert measured_worth([film_of(fresh(20))]) == pytest.approx(10, rel=0.1)


def test_several_clips_count_as_one_of_their_length() -> None:
    whole = fresh(80)
    parts = [film_of(whole[:30]), film_of(whole[30:])]
    assert measured_worth(parts) == pytest.approx(measured_worth([film_of(whole)]))


def test_a_habit_is_no_better_known_after_an_hour() -> None:
    habit = np.broadcast_to(np.random.default_rng(2).normal(0, 1, 15), (3600, 15))
    assert measured_worth([film_of(habit)]) == LEAST
