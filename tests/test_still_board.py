"""Rests of a board, by hand."""

import numpy as np

from calibration.board.still_board import (
    BoardVideo,
    Moments,
    Rest,
    moments_of,
    rests_of,
    seen_by,
    spread_moments,
)

GRID = np.array([(x, y) for y in range(3) for x in range(4)], float) * 20 + 100


def film(places: list[tuple[float, int]], late_s: float = 0.0) -> BoardVideo:
    """A board at a column for so many looks, five a second, then on its way for one."""
    times, px, now = [], [], late_s
    for column, looks in places:
        for _ in range(looks):
            times.append(now)
            px.append(GRID + np.array([column, 0.0]))
            now += 0.2
        now += 0.2
    return BoardVideo("a.avi", (640, 480), np.array(times), np.array(px))


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


def test_a_rest_lasts_a_third_of_a_second_and_shows_six_corners_half_of_the_time() -> None:
    """Three looks, 0.4 s; of two, 0.2 s, none. Corners that three of five looks show are told."""
    assert len(rests_of(film([(0.0, 3)]))) == 1
    assert rests_of(film([(0.0, 2)])) == []
    one = film([(0.0, 5)])
    one.px[:3, 6:] = np.nan
    (rest,) = rests_of(one)
    assert np.isfinite(rest.px[:, 0]).tolist() == [True] * 6 + [False] * 6
    one.px[:3, 5] = np.nan
    assert rests_of(one) == []


def test_a_board_is_at_rest_within_a_four_hundredth_of_the_width() -> None:
    """640 px: 1.6 px since it came to rest, as a root mean square over the corners."""
    for by_px, rests in ((1.59, 1), (1.61, 2)):
        one = film([(0.0, 8)])
        one.px[4:] += [by_px, 0.0]
        assert len(rests_of(one)) == rests


def test_a_film_joins_the_rest_with_which_it_shares_most_and_half_of_the_shorter() -> None:
    def rest(begin_s: float, end_s: float) -> Rest:
        return Rest(begin_s, end_s, GRID + begin_s)

    first = [rest(0.0, 2.0), rest(2.1, 6.0)]
    moments = moments_of([first, [rest(1.5, 3.5)]])
    assert seen_by(moments).tolist() == [[True, False], [True, True]]
    assert moments.begin_s.tolist() == [0.0, 2.1]
    assert moments.end_s.tolist() == [2.0, 6.0]
    assert np.allclose(moments.px[1, 1], GRID + 1.5)
    for end_s, together in ((1.0, True), (0.98, False)):
        one = moments_of([[rest(0.0, end_s)], [rest(0.5, 9.0)]])
        assert len(one.px) == (1 if together else 2)
    twice = moments_of([[rest(0.0, 8.0)], [rest(1.0, 3.0), rest(4.0, 6.0)]])
    assert seen_by(twice).tolist() == [[True, True], [False, True]]


def test_moments_that_are_needed_are_kept_besides_and_half_are_shared() -> None:
    px = np.full((6, 2, 12, 2), np.nan)
    for n, column in enumerate((0.0, 1.0, 2.0, 300.0, 301.0, 400.0)):
        px[n, 0] = GRID + np.array([column, 0.0])
    px[:3, 1] = GRID
    moments = Moments(np.arange(6.0), np.arange(6.0) + 0.5, px)
    needed = np.array([False, True, False, False, False, False])
    kept = spread_moments(moments, 4, needed)
    assert kept.begin_s.tolist() == [0.0, 1.0, 2.0, 3.0, 5.0]
    few = spread_moments(moments, 2, np.zeros(6, bool))
    assert few.begin_s.tolist() == [0.0, 3.0]
    assert few.end_s.tolist() == [0.5, 3.5]
