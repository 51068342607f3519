"""Views of other rates: of the faster those frames are looked at that meet the slower's."""

import msgspec
import numpy as np
import pytest

from common.video.clip_facts import ClipView
from common.video.shared_rate import at_one_rate


def view(number: int, hz: float, seconds: float = 10.0, late_s: float = 0.0) -> ClipView:
    size = (160, 120)
    frames = round(hz * seconds)
    return ClipView(number, f"cam{number}.avi", size, size, hz, frames, late_s=late_s)


@pytest.mark.parametrize(("slow_hz", "fast_hz"), [(25.0, 29.97), (15.0, 30.0), (24.0, 60.0)])
@pytest.mark.parametrize("fast", [1, 2])
def test_each_frame_of_the_slower_has_the_nearest_of_the_faster(
    slow_hz: float, fast_hz: float, fast: int
) -> None:
    views = (view(1, fast_hz if fast == 1 else slow_hz), view(2, fast_hz if fast == 2 else slow_hz))
    thin, whole = (at_one_rate(views, 1)[n - 1] for n in (fast, 3 - fast))
    assert whole == views[2 - fast]
    assert thin.fps == slow_hz
    own_s = np.arange(thin.frames) / fast_hz
    assert [thin.captured_s(n) for n in range(thin.frames)] == pytest.approx(own_s)
    for n in range(whole.frames - 2):
        nearest_s = np.abs(own_s[list(thin.picked)] - whole.captured_s(n)).min()
        assert nearest_s == pytest.approx(np.abs(own_s - whole.captured_s(n)).min(), abs=1e-9)
    assert abs(len(thin.picked) - whole.frames) <= 1


def test_a_view_that_is_late_is_met_where_it_shows_the_same() -> None:
    fast = at_one_rate((view(1, 15.0), view(2, 30.0, late_s=1.0)), 1)[1]
    assert fast.picked[:3] == (30, 32, 34)
    assert fast.captured_s(30) == pytest.approx(0.0)


def test_of_the_slower_every_third_frame_is_met() -> None:
    assert at_one_rate((view(1, 15.0), view(2, 30.0)), 3)[1].picked[:3] == (0, 6, 12)


def test_frames_that_are_looked_at_follow_each_other() -> None:
    fast = at_one_rate((view(1, 25.0), view(2, 50.0)), 1)[1]
    assert (fast.every(4), view(1, 25.0).every(4)) == (1, 4)
    assert [fast.is_looked_at(n) for n in range(4)] == [True, False, True, False]
    assert fast.next_s(2, 1) == pytest.approx(4 / 50)
    assert view(1, 25.0).next_s(2, 3) == pytest.approx(5 / 25)


def test_rates_that_are_nearly_one_and_cameras_are_left_alone() -> None:
    nearly = (view(1, 30.0), view(2, 29.97))
    assert at_one_rate(nearly, 1) == nearly
    camera = ClipView(2, 0, (160, 120), (160, 120), 30.0, 0)
    assert at_one_rate((view(1, 15.0), camera), 1) == (view(1, 15.0), camera)
    assert at_one_rate((view(1, 15.0),), 1) == (view(1, 15.0),)


def test_times_that_are_rounded_make_no_other_rate() -> None:
    """A phone's gaps of 33 and 34 ms: 30 a second, though most of them say 30.3."""
    gaps_s = np.tile([0.033, 0.033, 0.034], 100)
    times_s = tuple(np.concatenate([[0.0], np.cumsum(gaps_s)]).tolist())
    phone = msgspec.structs.replace(view(1, 1 / 0.033), capture_s=times_s, frames=len(times_s))
    steady = view(2, 30.0)
    assert at_one_rate((phone, steady), 1) == (phone, steady)


def test_the_slower_keeps_its_frames_and_the_faster_its_times_with_what_it_is_late() -> None:
    """By hand: 10 and 25 a second for 0.4 s, the faster 0.01 s late."""
    slow, fast = view(1, 10.0, 0.4), view(2, 25.0, 0.4, late_s=0.01)
    same, thin = at_one_rate((slow, fast), 1)
    assert same == slow
    assert (thin.fps, thin.late_s, thin.frames, thin.number) == (10.0, 0.01, 10, 2)
    assert thin.capture_s == pytest.approx([0.04 * n for n in range(10)])
    # of the slower at 0, 0.1, 0.2, 0.3; of the faster, set back, at -0.01, 0.03, 0.07, ...
    assert thin.picked == (0, 3, 5, 8)


def test_a_frame_that_is_farther_than_half_a_period_from_all_others_is_met_by_none() -> None:
    slow, fast = view(1, 10.0, 1.0), view(2, 20.0, 0.5)
    assert at_one_rate((slow, fast), 1)[1].picked == (0, 2, 4, 6, 8)
    early = msgspec.structs.replace(fast, late_s=-0.17)  # at 0.17, 0.22, 0.27, ...
    assert at_one_rate((slow, early), 1)[1].picked == (1, 3, 5, 7, 9)


@pytest.mark.parametrize(("ratio", "varies", "thinned"), [
    (1.009, False, False), (1.011, False, True), (1.049, True, False), (1.051, True, True),
])  # fmt: skip
def test_a_hundredth_is_another_rate_and_a_twentieth_where_times_are_rounded(
    ratio: float, varies: bool, thinned: bool
) -> None:
    slow, fast = view(1, 20.0), view(2, 20.0 * ratio)
    if varies:
        times_s = tuple(n / 20.0 for n in range(slow.frames))
        slow = msgspec.structs.replace(slow, capture_s=times_s)
    assert bool(at_one_rate((slow, fast), 1)[1].picked) == thinned


def test_of_several_all_that_are_faster_meet_the_slowest() -> None:
    first, second, third = at_one_rate((view(1, 30.0), view(2, 15.0), view(3, 60.0)), 1)
    assert (first.picked[:3], second.picked, third.picked[:3]) == ((0, 2, 4), (), (0, 4, 8))
    assert {one.fps for one in (first, second, third)} == {15.0}


def test_videos_of_a_killed_recording_are_met_by_their_times() -> None:
    """They claim no number of frames."""
    slow, fast = (
        msgspec.structs.replace(
            view(n, hz), frames=0, capture_s=tuple(k / hz for k in range(round(hz)))
        )
        for n, hz in ((1, 15.0), (2, 30.0))
    )
    thin = at_one_rate((slow, fast), 1)[1]
    assert thin.picked == tuple(range(0, 30, 2))
    assert thin.next_s(28, 1) == pytest.approx(1.0, abs=0.04)
