"""A person between instants: how fast they walk, and what they wear."""

from typing import Any

import msgspec
import numpy as np
import pytest
from crowd_of_two import BLUE, LEFT_M, RED, shown
from test_owners import life

from common.bus.messages import Body
from integrator.people.known_life import CARRIED_S, FASTEST_M_S, NEW_SHARE, Life, after

SEEN = tuple(shown(LEFT_M, (3, 4), RED))


def body_at(x_m: float, status: Any = "tracking") -> Body:
    places = tuple((x_m, 1.0, 0.0) for _ in range(15))
    moment: dict[str, Any] = {"frame": 0, "captured_s": 0.0, "clock_s": 0.0}
    return Body(status=status, views="both", joints_m=places, **moment)


def walking(speed_m_s: float, instants: int = 30) -> Life:
    known = life(1, LEFT_M)._replace(joints_m=None, colours=())
    for n in range(instants):
        known = after(known, body_at(speed_m_s * n / 15.0), SEEN, n / 15.0)
    return known


def test_who_walks_is_expected_ahead_for_half_a_second() -> None:
    known = walking(1.2)
    last_s, last_x_m = known.joints_s, 1.2 * 29 / 15.0
    for later_s, ahead_s in ((0.2, 0.2), (CARRIED_S, CARRIED_S), (3.0, CARRIED_S)):
        expected_m = known.expected_m(last_s + later_s)
        assert expected_m is not None
        assert expected_m[0, 0] == pytest.approx(last_x_m + 1.2 * ahead_s, abs=0.01)


def test_nobody_is_faster_than_a_runner() -> None:
    assert np.linalg.norm(walking(20.0).velocity_m_s) == pytest.approx(FASTEST_M_S)


def test_a_body_that_is_not_believed_places_nobody_but_is_seen() -> None:
    known = walking(0.0)
    later = after(known, body_at(9.0, "predicted"), SEEN, 2.5)
    assert (later.joints_s, later.seen_s, later.tracks) == (known.joints_s, 2.5, (3, 4))
    assert later.joints_m is known.joints_m


def test_a_view_that_does_not_show_them_leaves_what_it_said_before() -> None:
    known = after(walking(0.0), body_at(0.0), (None, SEEN[1]), 2.5)
    assert (known.tracks, known.views_s) == ((3, 4), (29 / 15.0, 2.5))
    assert after(known, body_at(5.0), (None, None), 3.0) is known


def test_colours_are_a_views_own_and_follow_slowly() -> None:
    known = walking(0.0, 200)
    assert known.coloured == (200, 200)
    other = (SEEN[0] and msgspec.structs.replace(SEEN[0], colours=BLUE), None)
    later = after(known, body_at(0.0), other, 14.0)
    np.testing.assert_allclose(
        later.colours_in(0), (1.0 - NEW_SHARE) * np.array(RED) + NEW_SHARE * np.array(BLUE)
    )
    assert later.colours_in(1) == pytest.approx(RED)


def test_the_first_instants_count_alike() -> None:
    other = tuple(one and msgspec.structs.replace(one, colours=BLUE) for one in SEEN)
    known = after(walking(0.0, 1), body_at(0.0), other, 0.2)
    np.testing.assert_allclose(known.colours_in(0), (np.array(RED) + np.array(BLUE)) / 2)


def test_colours_of_a_view_that_never_showed_them_are_those_of_another() -> None:
    known = life(1, LEFT_M)._replace(colours=((), BLUE))
    assert (known.colours_in(0), known.colours_in(1)) == (BLUE, BLUE)
    assert known._replace(colours=()).colours_in(0) == ()


def test_who_was_never_believed_is_nowhere() -> None:
    assert life(1, LEFT_M)._replace(joints_m=None).expected_m(1.0) is None
