"""Rests of a board, by hand."""

import numpy as np

from integrator.board.still_board import Film, moments_of, rests_of, seen_by, spread_moments

GRID = np.array([(x, y) for y in range(3) for x in range(4)], float) * 20 + 100


def film(places: list[tuple[float, int]], late_s: float = 0.0) -> Film:
    """A board at a column for so many looks, five a second, then on its way for one."""
    times, px, now = [], [], late_s
    for column, looks in places:
        for _ in range(looks):
            times.append(now)
            px.append(GRID + np.array([column, 0.0]))
            now += 0.2
        now += 0.2
    return Film("a.avi", (640, 480), np.array(times), np.array(px))


def test_a_rest_is_a_stretch_of_the_same_place() -> None:
    rests = rests_of(film([(0.0, 5), (50.0, 8), (200.0, 1)]))
    assert [round(rest.end_s - rest.begin_s, 3) for rest in rests] == [0.8, 1.4]
    assert np.allclose(rests[1].px, GRID + np.array([50.0, 0.0]))


def test_a_board_that_drifts_is_not_at_rest() -> None:
    assert rests_of(film([(4.0 * n, 1) for n in range(20)])) == []


def test_one_bad_look_does_not_move_a_corner() -> None:
    one = film([(0.0, 7)])
    one.px[3, 0] += 1.0
    (rest,) = rests_of(one)
    assert np.allclose(rest.px, GRID)


def test_rests_at_one_time_are_one_moment_though_a_film_began_late() -> None:
    held = [(60.0 * n, 10) for n in range(5)]
    moments = moments_of([rests_of(film(held)), rests_of(film(held, late_s=0.7))])
    assert seen_by(moments).tolist() == [[True, True]] * 5


def test_rests_at_other_times_stay_apart() -> None:
    first, second = film([(0.0, 10)]), film([(0.0, 10)], late_s=1.7)
    moments = moments_of([rests_of(first), rests_of(second)])
    assert seen_by(moments).tolist() == [[True, False], [False, True]]


def test_of_many_moments_the_most_different_are_kept() -> None:
    columns = [0.0, 1.7, 3.4, 5.1, 6.8, 300.0]
    moments = moments_of([rests_of(film([(column, 4) for column in columns]))])
    needed = np.zeros(len(moments.px), bool)
    assert len(moments.px) == 6
    kept = spread_moments(moments, 4, needed)
    assert kept.px[:, 0, 0, 0].tolist() == [100.0, 400.0]
