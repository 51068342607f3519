"""Scripts: where a person is and where they look."""

import numpy as np
import pytest

from synth.scene.script import RAMP_S, Script, Turn, Walk, headings, length_m, places, towards_deg

TIME_S = np.arange(0.0, 8.0, 1 / 15)
WALK = Walk(1.0, 4.0, np.array([[0.0, 0.0], [3.0, 0.0]]))


def test_a_walk_begins_slowly_goes_on_evenly_and_ends_at_its_end() -> None:
    """3 m in 3 s with ramps of 0.45 s: 3 / 2.55 m/s between them."""
    x = places(Script(np.zeros(2), (WALK,)), TIME_S)[:, 0]
    assert (x[TIME_S <= 1.0] == 0.0).all()
    np.testing.assert_allclose(x[TIME_S >= 4.0], 3.0)
    speed = np.diff(x) * 15
    even = (TIME_S[:-1] > 1.0 + RAMP_S) & (TIME_S[1:] < 4.0 - RAMP_S)
    np.testing.assert_allclose(speed[even], 3.0 / (3.0 - RAMP_S), rtol=0.01)
    assert (speed >= -1e-9).all()
    assert speed[15] < 0.6


def test_a_curve_passes_its_points_and_a_second_walk_goes_on() -> None:
    bent = Walk(1.0, 4.0, np.array([[0.0, 0.0], [1.0, 0.5], [2.0, 0.0]]))
    on = Walk(5.0, 6.0, np.array([[2.0, 0.0], [2.0, 1.0]]))
    script = Script(np.zeros(2), (bent, on))
    way = places(script, TIME_S)
    assert np.linalg.norm(way - [1.0, 0.5], axis=1).min() < 0.05
    np.testing.assert_allclose(way[TIME_S >= 6.0], [[2.0, 1.0]] * int((TIME_S >= 6.0).sum()))
    np.testing.assert_array_equal(script.end_m, [2.0, 1.0])
    assert length_m(on.points_m) == 1.0


def test_people_look_where_they_walk_unless_they_step_back_and_turn_the_short_way() -> None:
    """+x is 90 degrees, -z is 180: from 170 to -170 it is 20 degrees."""
    yaw = headings(Script(np.zeros(2), (WALK,), (Turn(5.0, 170.0), Turn(6.5, -170.0))), TIME_S)
    assert yaw[0] == pytest.approx(0.0, abs=1e-6)
    assert yaw[int(2.5 * 15)] == pytest.approx(90.0)
    assert yaw[int(5.8 * 15)] == pytest.approx(170.0, abs=0.5)
    assert yaw[-1] == pytest.approx(190.0, abs=1e-6)
    assert np.abs(np.diff(yaw)).max() * 15 < 400.0
    back = Script(np.zeros(2), (WALK._replace(facing_deg=-90.0),))
    assert headings(back, TIME_S)[40] == pytest.approx(-90.0)
    assert towards_deg(np.zeros(2), np.array([0.0, -1.0])) == pytest.approx(180.0)
    assert towards_deg(np.ones(2), np.array([2.0, 1.0])) == pytest.approx(90.0)
