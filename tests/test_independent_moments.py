"""What a film counts, held against errors that are known to last."""

import numpy as np
import pytest

from calibration.person.independent_moments import LEAST, measured_worth
from calibration.person.rig_residuals import Explained
from calibration.tracks.sight_lines import Meeting, Numbers


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


def test_what_films_count_worked_by_hand() -> None:
    """Two joints of two clips: of four moments one joint is used in all, the other in three; a
    gap of 9 sigmas counts as 3, to either side."""
    one = film_of(np.array([[0.2, 0.5], [9.0, 0.1]]))
    two = film_of(np.array([[-0.4, -7.0], [0.0, 0.9]]))
    one.used[:] = [[True, False], [True, True]]
    two.met.before[:] = [[True, True], [False, True]]
    two = two._replace(used=np.ones((2, 2), bool))
    means = (0.2 + 3.0 - 0.4) / 3, (0.1 - 3.0 + 0.9) / 3
    lasting = (3 * means[0] ** 2 + 3 * means[1] ** 2) / 6
    assert 1.0 / (lasting * (1.0 + 20.0 * lasting)) < LEAST
    assert measured_worth([one, two]) == LEAST
    small = [each._replace(met=each.met._replace(gap=0.14 * each.met.gap)) for each in (one, two)]
    means = 0.14 * (0.2 + 9.0 - 0.4) / 3, 0.14 * (0.1 - 7.0 + 0.9) / 3
    lasting = (3 * means[0] ** 2 + 3 * means[1] ** 2) / 6
    expected = 1.0 / (lasting * (1.0 + 20.0 * lasting))
    assert 2.0 < expected < 4.0
    assert measured_worth(small) == pytest.approx(expected)
    calm = [each._replace(met=each.met._replace(gap=1e-6 * each.met.gap)) for each in (one, two)]
    assert measured_worth(calm) == pytest.approx(4.0), "no more than there are moments"
