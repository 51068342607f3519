"""By how much each of several cameras is late, held against clips that were shifted."""

import pytest
from many_views import around, shown

from calibration.tracks import camera_clocks
from calibration.tracks.camera_clocks import clock_between, clocks_of
from calibration.tracks.joint_tracks import JointTrack, Sighting, Sightings
from calibration.tracks.lateness import UNSEEN, Clock

PERIOD_S = 1 / 15
LATE_S = (0.0, 0.4, -0.3)


def test_each_camera_has_its_own_delay_against_the_first() -> None:
    found = clocks_of(shown(around(3), 8, "squat", LATE_S))
    assert [clock.is_found for clock in found] == [True, True]
    assert [clock.late_s for clock in found] == pytest.approx(LATE_S[1:], abs=PERIOD_S)


def named(*names: float) -> Sightings:
    """Views that are known by the time of their only frame."""
    empty = shown(around(2), 8, "squat").tracks[0]
    cut = JointTrack(*(part[:2] for part in empty))
    return Sightings(tuple(cut._replace(times_s=cut.times_s + name) for name in names), (160, 120))


def test_what_the_first_camera_leaves_open_a_third_one_decides(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Camera 3 shares too little with camera 1, and camera 4 with both: 0.2 + 0.3, and 0.1 more."""
    told = {(0, 1): Clock(0.2), (1, 2): Clock(0.3, (), False), (2, 3): Clock(0.1)}

    def clock_of(sighting: Sighting) -> Clock:
        first, second = (int(track.times_s[0]) for track in (sighting.first, sighting.second))
        return told.get((first, second), UNSEEN)

    monkeypatch.setattr(camera_clocks, "clock_of", clock_of)
    two, three, four = clocks_of(named(0, 1, 2, 3))
    assert two == Clock(0.2)
    assert three == Clock(0.5, (), False)
    assert four.is_found
    assert four.late_s == pytest.approx(0.6)
    assert clocks_of(named(0, 2)) == (UNSEEN,)


def test_a_frame_that_one_pair_errs_by_is_outvoted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Camera 3 seems a frame late to camera 1 alone; one that is late is so to all."""
    told = {(0, 1): 0.0, (0, 2): 0.07, (0, 3): 0.3, (1, 2): 0.0, (3, 2): -0.3}
    told |= {(1, 3): 0.3, (2, 3): 0.3}

    def clock_of(sighting: Sighting) -> Clock:
        first, second = (int(track.times_s[0]) for track in (sighting.first, sighting.second))
        return Clock(told[first, second])

    monkeypatch.setattr(camera_clocks, "clock_of", clock_of)
    assert [clock.late_s for clock in clocks_of(named(0, 1, 2, 3))] == pytest.approx([0, 0, 0.3])
    assert [clock.late_s for clock in clocks_of(named(0, 1, 2))] == pytest.approx([0.0, 0.0])
    assert clocks_of(named(0, 2)) == (Clock(0.07),), "two cameras have no third"


def test_the_delay_between_two_is_the_difference_of_theirs_where_both_are_found() -> None:
    clocks = (Clock(0.2), Clock(0.5), Clock(0.4, (1.0,)))
    assert clock_between(clocks, 0, 3) == Clock(0.4, (1.0,))
    for one, other, late_s in ((1, 2, 0.3), (2, 1, -0.3)):
        between = clock_between(clocks, one, other)
        assert between is not None
        assert between.late_s == pytest.approx(late_s)
    assert clock_between(clocks, 2, 0) == Clock(-0.5)
    assert clock_between(clocks, 1, 3) is None
