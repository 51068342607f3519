"""By how much one view is late, held against clips that were shifted."""

from typing import Final

import numpy as np
import pytest
from test_person_calibration import PAPER, filmed_by_the_papers_rig
from wild_rigs import AT, Film, seen, walked

from calibration.tracks import lateness
from calibration.tracks.joint_tracks import JointTrack, Sighting
from calibration.tracks.late_fit import LEAST_SHARED, Fit, fits_of
from calibration.tracks.lateness import UNSEEN, clock_of
from calibration.tracks.moving_alike import alike, promising
from synth.motion.motions import performance
from synth.person.people import person

WALKS: Final = filmed_by_the_papers_rig(3, "walk_slow_bigswing").sighting
SHOWN: Final = filmed_by_the_papers_rig(8, "squat").sighting
PERIOD_S: Final = 1 / 15
CYCLE_S: Final = 40 / 15
"""After so long made-up walks repeat themselves, to the last hair."""
MOST_FITS: Final = 600
"""Of a clip of any length: a second or two."""
OPENING: Final = 24
"""Frames of a T, and of arms that come down."""


def walking(seed: int) -> Sighting:
    """Eight seconds of steps on the spot alone."""
    someone = person(seed)
    motion = performance(someone, "walk_in_place", seed, 15.0, 8.0)
    steps_m = motion.joints_m[motion.present][OPENING:, AT]
    film = Film(steps_m, np.ones(len(steps_m), bool), motion.fps)
    return seen(film, PAPER, 0.0, np.random.default_rng(seed))


def late(sighting: Sighting, by_s: float) -> Sighting:
    second = sighting.second._replace(times_s=sighting.second.times_s + by_s)
    return sighting._replace(second=second)


def from_frame(track: JointTrack, first: int) -> JointTrack:
    """What a camera shows that was started so many frames later, by times of its own."""
    rest = JointTrack(*(part[first:] for part in track))
    return rest._replace(times_s=rest.times_s - rest.times_s[0])


@pytest.mark.parametrize("by_s", [-7.0, -0.5, 0.0, 0.2, 3.0])
@pytest.mark.parametrize("shown", [WALKS, SHOWN], ids=["walks", "squats"])
def test_a_view_whose_clock_is_late_is_found_within_a_frame(shown: Sighting, by_s: float) -> None:
    found = clock_of(late(shown, by_s))
    assert found.is_found
    assert found.late_s == pytest.approx(by_s, abs=PERIOD_S)
    assert found.may_be_on_time == (abs(by_s) < 0.5) or by_s == 0.2


@pytest.mark.parametrize("frames", [6, 12])
def test_a_camera_that_was_started_later_shows_all_earlier(frames: int) -> None:
    found = clock_of(WALKS._replace(second=from_frame(WALKS.second, frames)))
    assert found.late_s == pytest.approx(-frames * PERIOD_S, abs=PERIOD_S)
    found = clock_of(WALKS._replace(first=from_frame(WALKS.first, frames)))
    assert found.late_s == pytest.approx(frames * PERIOD_S, abs=PERIOD_S)


@pytest.mark.parametrize("seed", [3, 5])
@pytest.mark.parametrize("by_s", [0.0, 1.0])
def test_a_gait_that_repeats_itself_is_called_ambiguous(seed: int, by_s: float) -> None:
    found = clock_of(late(walking(seed), by_s))
    assert found.state == "ambiguous"
    assert found.rivals_s
    likely_s = np.array([found.late_s, *found.rivals_s])
    cycles = (likely_s - by_s) / CYCLE_S
    assert (np.abs(cycles - np.round(cycles)) < 2 * PERIOD_S / CYCLE_S).any()


def test_who_stands_still_shows_no_time() -> None:
    still = JointTrack(*(np.repeat(part[20:21], 60, axis=0) for part in WALKS.first))
    still = still._replace(times_s=np.linspace(0.0, 59 * PERIOD_S, 60))
    assert not clock_of(WALKS._replace(first=still, second=still)).is_found


def test_cameras_of_other_rates_are_told_apart_in_seconds() -> None:
    every_other = JointTrack(*(part[::2] for part in WALKS.second))
    found = clock_of(late(WALKS._replace(second=every_other), 1.0))
    assert found.is_found
    assert found.late_s == pytest.approx(1.0, abs=PERIOD_S)


def test_of_less_than_two_seconds_in_common_no_clock_is_told() -> None:
    short = JointTrack(*(part[30:58] for part in WALKS.second))
    assert clock_of(WALKS._replace(second=short)) == UNSEEN


def test_a_view_that_shows_nobody_has_no_clock() -> None:
    blind = SHOWN.second._replace(confidence=np.zeros_like(SHOWN.second.confidence))
    assert clock_of(SHOWN._replace(second=blind)) == UNSEEN
    few = JointTrack(*(part[: LEAST_SHARED - 1] for part in SHOWN.second))
    assert clock_of(SHOWN._replace(second=few)) == UNSEEN
    assert UNSEEN.state == "unknown"
    assert UNSEEN.may_be_on_time


@pytest.fixture(scope="module")
def long_walk() -> Sighting:
    """Two minutes of walks through the room, each another way."""
    film = walked(person(9101), 9101, 15.0, 17)
    return seen(film, PAPER, 0.0, np.random.default_rng(9101))


def cut(sighting: Sighting, frames: int) -> Sighting:
    """The same whose view 1 was started so many frames later than view 2: then view 2 is late."""
    return sighting._replace(
        first=from_frame(sighting.first, max(frames, 0)),
        second=from_frame(sighting.second, max(-frames, 0)),
    )


@pytest.mark.parametrize("frames", [-700, -9, 0, 330])
def test_both_views_move_most_alike_where_they_show_one_instant(
    long_walk: Sighting, frames: int
) -> None:
    shown, steps = cut(long_walk, frames), np.arange(-1600, 1601)
    scores = alike(shown.first, shown.second, steps, PERIOD_S)
    assert steps[np.argmax(scores)] == pytest.approx(frames, abs=1)
    assert frames in promising(shown.first, shown.second, steps, PERIOD_S)


@pytest.mark.slow
@pytest.mark.parametrize("frames", [-700, -9, 0, 330])
def test_a_view_of_a_long_clip_is_found_as_by_trying_all_with_few_fits(
    long_walk: Sighting, frames: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = cut(long_walk, frames)
    tried_s: list[float] = []

    def counted(views: tuple[JointTrack, JointTrack], each_s: list[float]) -> list[Fit]:
        tried_s.extend(each_s)
        return fits_of(views, each_s)

    monkeypatch.setattr(lateness, "fits_of", counted)
    found = clock_of(shown)
    assert found.is_found
    assert found.late_s == pytest.approx(frames * PERIOD_S, abs=PERIOD_S)
    assert found.may_be_on_time == (frames == 0)
    assert len(tried_s) < MOST_FITS
    assert 0.0 in tried_s
