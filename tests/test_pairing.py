"""Pairs of reports: by the time they were taken, whatever the order they are heard in."""

import itertools
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.bus import clock
from common.bus.clock import Exchange
from common.bus.instant import Instant
from common.bus.messages import View, ViewerNumber
from integrator.hearing.subscriber import OVERDUE_PERIODS
from integrator.pairing import QUEUE, State, away, begin, end, init, overdue, step

PERIOD_S = 1 / 15


def report(
    viewer: ViewerNumber, captured_s: float, frame: int = 0, next_s: float | None = None
) -> View:
    return View(
        viewer=viewer,
        frame=frame,
        captured_s=captured_s,
        clock_s=captured_s,
        width=8,
        height=1,
        next_s=next_s,
    )


def heard(state: State, reports: Sequence[View]) -> tuple[State, list[Instant]]:
    pairs: list[Instant] = []
    for one in reports:
        state, more = step(state, one)
        pairs += more
    return state, pairs


def times(pairs: Sequence[Instant]) -> list[tuple[float | None, ...]]:
    return [tuple(None if one is None else one.captured_s for one in pair.views) for pair in pairs]


def test_reports_of_one_instant_go_out_together() -> None:
    state, pairs = heard(
        init(1.0), [report(1, 0.0), report(2, 0.5), report(2, 1.4), report(1, 1.0)]
    )
    assert times(pairs) == [(0.0, 0.5), (1.0, 1.4)]
    assert (state.dropped, state.late) == (0, 0)


def test_a_report_goes_out_alone_once_its_partner_cannot_come() -> None:
    """The other viewer lost a frame, and says so by sending the next."""
    state, pairs = heard(init(1.0), [report(1, 0.0), report(1, 1.0)])
    assert pairs == []
    state, pairs = step(state, report(2, 1.1))
    assert times(pairs) == [(0.0, None), (1.0, 1.1)]


def test_half_a_period_apart_is_together_and_more_is_not() -> None:
    assert times(heard(init(1.0), [report(1, 0.0), report(2, 0.5)])[1]) == [(0.0, 0.5)]
    assert times(heard(init(1.0), [report(1, 0.0), report(2, 0.5001)])[1]) == [(0.0, None)]


@pytest.mark.parametrize(("fast", "slow"), [(1, 2), (2, 1)])
def test_a_camera_twice_as_fast_is_paired_at_the_very_moments_of_the_slower(
    fast: ViewerNumber, slow: ViewerNumber
) -> None:
    """Both meet every second: half a second before, it has a frame that is nearly one."""
    talk = [report(fast, n / 2, next_s=(n + 1) / 2) for n in range(6)]
    talk += [report(slow, float(n), next_s=n + 1.0) for n in range(3)]
    state, pairs = heard(init(1.0), sorted(talk, key=lambda one: (one.captured_s, one.viewer)))
    state, rest = flush(state)
    whole = [pair for pair in times([*pairs, *rest]) if None not in pair]
    assert (whole, state.late) == ([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)], 0)


def flush(state: State) -> tuple[State, list[Instant]]:
    """Both viewers have said their last."""
    state, first = end(state, 1)
    state, second = end(state, 2)
    return state, first + second


def test_what_waits_goes_out_at_the_end() -> None:
    state, _ = heard(init(1.0), [report(2, 0.0), report(2, 1.0)])
    state, pairs = flush(state)
    assert times(pairs) == [(None, 0.0), (None, 1.0)]
    assert state.waiting == ((), ())


def test_nobody_waits_for_a_viewer_that_has_ended() -> None:
    state, pairs = heard(init(1.0), [report(1, 0.0), report(2, 0.0), report(1, 1.0)])
    assert times(pairs) == [(0.0, 0.0)]
    state, pairs = end(state, 2)
    assert times(pairs) == [(1.0, None)]
    assert times(step(state, report(1, 2.0))[1]) == [(2.0, None)]


@pytest.mark.parametrize("viewer", [1, 2])
def test_a_single_viewers_reports_pass_through(viewer: ViewerNumber) -> None:
    other: ViewerNumber = 2 if viewer == 1 else 1
    state = init(1.0, viewers=(viewer,))
    for second in range(3):
        state, pairs = step(state, report(viewer, float(second)))
        assert [one for pair in pairs for one in pair.views if one] == [
            report(viewer, float(second))
        ]
    assert step(state, report(other, 3.0)) == (state._replace(late=1), [])


def test_a_report_that_comes_too_late_is_counted_and_dropped() -> None:
    state, _ = heard(init(1.0), [report(1, 0.0)])
    state, pairs = overdue(state, now_s=0.21, wait_s=0.2)
    assert times(pairs) == [(0.0, None)]
    state, pairs = step(state, report(2, 0.3))
    assert (pairs, state.late, state.waiting) == ([], 1, ((), ()))
    _, pairs = heard(state, [report(2, 1.1), report(1, 1.0)])
    assert times(pairs) == [(1.0, 1.1)]


def test_a_viewer_that_repeats_itself_is_not_heard_twice() -> None:
    state, pairs = heard(
        init(1.0), [report(1, 1.0), report(1, 1.0), report(1, 0.0), report(2, 1.0)]
    )
    assert times(pairs) == [(1.0, 1.0)]
    assert state.late == 2


def test_a_report_that_overtook_an_older_one_makes_that_one_late() -> None:
    state, pairs = heard(init(1.0), [report(1, 1.0), report(1, 0.0)])
    state, pairs = flush(state)
    assert times(pairs) == [(1.0, None)]
    assert state.late == 1


def test_what_waited_long_enough_is_overdue_and_what_waits_behind_it_too() -> None:
    state, _ = heard(init(1.0), [report(1, 0.0), report(1, 1.0)])
    assert overdue(state, now_s=0.2, wait_s=0.2) == (state, [])
    state, pairs = overdue(state, now_s=0.3, wait_s=0.2)
    assert times(pairs) == [(0.0, None), (1.0, None)]
    assert state.late == 0


def test_a_full_queue_drops_its_oldest_and_counts() -> None:
    state, pairs = heard(init(1.0), [report(1, float(second)) for second in range(QUEUE + 5)])
    assert pairs == []
    assert state.dropped == 5
    assert state.waiting[0][0].captured_s == 5.0
    _, pairs = flush(state)
    assert len(pairs) == QUEUE


def test_nobody_is_waited_for_after_two_missed_frames() -> None:
    """Issue 5, step 7: single-view poses begin after two missed frames, and then at once."""
    state, _ = heard(init(1.0), [report(1, 0.0), report(2, 0.0), report(1, 1.0), report(1, 2.0)])
    wait_s = OVERDUE_PERIODS * 1.0
    assert overdue(state, now_s=2.9, wait_s=wait_s) == (state, [])
    state, pairs = overdue(state, now_s=3.1, wait_s=wait_s)
    assert times(pairs) == [(1.0, None), (2.0, None)]
    assert times(step(state, report(1, 3.0))[1]) == [(3.0, None)]


def test_who_is_back_is_waited_for_again() -> None:
    """Its first report comes too late for its instant, and shows that it is there."""
    state, _ = away(heard(init(1.0), [report(1, 0.0), report(2, 0.0)])[0], 2)
    assert times(step(state, report(1, 1.0))[1]) == [(1.0, None)]
    state, pairs = heard(state, [report(1, 1.0), report(2, 1.0), report(1, 2.0)])
    assert (times(pairs), state.late) == ([(1.0, None)], 1)
    assert times(step(state, report(2, 2.0))[1]) == [(2.0, 2.0)]


def test_frames_of_long_ago_do_not_bring_a_viewer_back() -> None:
    """One that hung finds old frames in its camera's queue first."""
    state, _ = away(heard(init(1.0), [report(1, 0.0), report(2, 0.0)])[0], 2)
    state, pairs = heard(state, [report(1, 5.0), report(2, 1.0), report(1, 6.0)])
    assert times(pairs) == [(5.0, None), (6.0, None)]


def test_a_viewer_that_is_known_to_be_gone_keeps_nobody_waiting() -> None:
    state, _ = step(init(1.0), report(1, 0.0))
    state, pairs = away(state, 2)
    assert times(pairs) == [(0.0, None)]


def test_a_viewer_that_ended_may_begin_again() -> None:
    state, _ = end(init(1.0), 2)
    state, pairs = heard(begin(state, 2), [report(1, 0.0), report(2, 0.0)])
    assert times(pairs) == [(0.0, 0.0)]


@pytest.mark.parametrize("viewer", [1, 2])
def test_who_begins_again_is_not_bound_by_the_next_frame_that_was_announced(
    viewer: ViewerNumber,
) -> None:
    """Else its partner's frame of 1 s goes out alone, for no frame was to come before 9 s."""
    partner: ViewerNumber = 2 if viewer == 1 else 1
    state, _ = heard(init(1.0), [report(viewer, 0.0, next_s=9.0), report(partner, 0.0)])
    state = begin(end(state, viewer)[0], viewer)
    state, pairs = step(state, report(partner, 1.0))
    assert pairs == []
    assert times(step(state, report(viewer, 1.0))[1]) == [(1.0, 1.0)]


def test_a_frame_that_is_known_to_be_missing_is_not_waited_for() -> None:
    """A clip with frames missing in one camera, its viewer tells when the next one comes."""
    state, _ = heard(init(1.0), [report(1, 0.0, next_s=1.0), report(2, 0.0, next_s=3.0)])
    state, pairs = heard(state, [report(1, 1.0), report(1, 2.0)])
    assert times(pairs) == [(1.0, None), (2.0, None)]
    state, pairs = step(state, report(1, 3.0))
    assert pairs == []
    assert times(step(state, report(2, 3.0))[1]) == [(3.0, 3.0)]


@st.composite
def talks(draw: st.DrawFn) -> tuple[list[View], list[View]]:
    """Two viewers with jitter of 45 % of a period, lost frames and a shift between them.

    Some know when their next frame is taken.
    """
    both: list[list[View]] = []
    for viewer in (1, 2):
        shift = draw(st.floats(-0.5, 0.5))
        frames = sorted(draw(st.sets(st.integers(0, 20))))
        taken = [n + shift + draw(st.floats(-0.45, 0.45)) for n in frames]
        known = draw(st.booleans())
        both.append(
            [
                report(viewer, moment, n, next_s if known else None)
                for n, moment, next_s in zip(frames, taken, [*taken, 99.0][1:], strict=True)
            ]
        )
    return both[0], both[1]


@st.composite
def interleaved(draw: st.DrawFn) -> tuple[list[View], list[View]]:
    """The same talk as heard in two ways."""
    first, second = draw(talks())
    ways = []
    for _ in range(2):
        turns = draw(st.permutations([0] * len(first) + [1] * len(second)))
        speakers = (iter(first), iter(second))
        ways.append([next(speakers[turn]) for turn in turns])
    return ways[0], ways[1]


@given(interleaved())
def test_what_goes_out_does_not_depend_on_how_the_viewers_are_interleaved(
    ways: tuple[list[View], list[View]],
) -> None:
    ends = []
    for way in ways:
        state, pairs = heard(init(1.0), way)
        state, rest = flush(state)
        ends.append((pairs + rest, state.late, state.dropped))
    assert ends[0] == ends[1]


@given(talks(), st.floats(0.0, 3.0))
def test_every_report_goes_out_once_in_the_order_of_time_or_is_counted(
    talk: tuple[list[View], list[View]], wait_s: float
) -> None:
    """Even where reports are called overdue: nothing is lost without a count."""
    state, pairs = init(1.0), []
    for one in sorted((*talk[0], *talk[1]), key=lambda one: one.captured_s + 0.3 * one.viewer):
        state, more = step(state, one)
        state, old = overdue(state, one.clock_s, wait_s)
        pairs += more + old
    state, rest = flush(state)
    pairs += rest
    views = zip(*(pair.views for pair in pairs), strict=True)
    out = [[one for one in view if one] for view in views] or [[], []]
    assert len(out[0]) + len(out[1]) + state.late == len(talk[0]) + len(talk[1])
    for view in out:
        assert all(a.captured_s < b.captured_s for a, b in itertools.pairwise(view))
    moments = [max(one.captured_s for one in pair.views if one) for pair in pairs]
    assert all(a < b for a, b in itertools.pairwise(moments))
    for first, second in (pair.views for pair in pairs):
        if first and second:
            assert abs(first.captured_s - second.captured_s) <= 0.5


@st.composite
def talks_of_three(draw: st.DrawFn) -> list[list[View]]:
    """What three viewers say, of cameras that do not run in step and miss frames."""
    said = []
    for viewer in (1, 2, 3):
        shift, rate = draw(st.floats(-0.5, 0.5)), draw(st.sampled_from([1, 1, 2]))
        frames = sorted(draw(st.sets(st.integers(0, 12))))
        taken = [n / rate + shift + draw(st.floats(-0.2, 0.2)) / rate for n in frames]
        known = draw(st.booleans())
        said.append(
            [
                report(viewer, moment, n, next_s if known else None)
                for n, moment, next_s in zip(frames, taken, [*taken, 99.0][1:], strict=True)
            ]
        )
    return said


def heard_as(said: list[list[View]], turns: Sequence[int]) -> tuple[State, list[Instant]]:
    """What three viewers say, each in turn, to the end."""
    speakers = [iter(own) for own in said]
    state, found = heard(init(1.0, (1, 2, 3), cameras=3), [next(speakers[n]) for n in turns])
    for viewer in (1, 2, 3):
        state, rest = end(state, viewer)
        found += rest
    return state, found


def turns_of(said: list[list[View]]) -> list[int]:
    return [n for n, own in enumerate(said) for _ in own]


@given(talks_of_three(), st.data())
def test_what_three_viewers_say_goes_out_alike_however_they_are_interleaved(
    said: list[list[View]], data: st.DataObject
) -> None:
    ways = [heard_as(said, data.draw(st.permutations(turns_of(said)))) for _ in range(2)]
    assert ways[0][1] == ways[1][1]
    assert ways[0][0].late == ways[1][0].late


@given(talks_of_three(), st.data(), st.floats(0.0, 3.0))
def test_every_report_of_three_viewers_is_in_one_instant_or_counted(
    said: list[list[View]], data: st.DataObject, wait_s: float
) -> None:
    """An instant lies within half a period of each of its views, also where some are overdue."""
    speakers = [iter(own) for own in said]
    state, found = init(1.0, (1, 2, 3), cameras=3), list[Instant]()
    for n in data.draw(st.permutations(turns_of(said))):
        one = next(speakers[n])
        state, more = step(state, one)
        state, old = overdue(state, one.clock_s, wait_s)
        found += more + old
    for viewer in (1, 2, 3):
        state, rest = end(state, viewer)
        found += rest
    out = [one for instant in found for one in instant.views if one]
    assert len(out) == len({id(one) for one in out})
    assert len(out) + state.late + state.dropped == sum(map(len, said))
    assert state.waiting == ((), (), ())
    for instant in found:
        assert [one and one.viewer for one in instant.views] in (
            [n if one else None for n, one in enumerate(instant.views, 1)],
        )
        times_s = [one.captured_s for one in instant.views if one]
        assert any(max(abs(at_s - other) for other in times_s) <= 0.5 for at_s in times_s)


def test_three_cameras_a_third_of_a_period_apart_are_of_one_instant() -> None:
    """The first and the last are farther apart than half a period: the second is the instant."""
    talk = [report(n + 1, frame + n / 3, frame) for frame in range(4) for n in range(3)]
    _, found = heard(init(1.0, (1, 2, 3), cameras=3), talk)
    assert [[one and one.frame for one in instant.views] for instant in found] == [
        [frame] * 3 for frame in range(4)
    ]


def test_an_instant_of_three_waits_for_the_view_that_may_still_come_and_for_no_other() -> None:
    three = init(1.0, (1, 2, 3), cameras=3)
    state, found = heard(three, [report(1, 0.0, next_s=1.0), report(2, 0.1, next_s=1.1)])
    assert found == []
    assert len(away(state, 3)[1]) == 1
    state, found = step(state, report(3, 0.9))
    assert times(found) == [(0.0, 0.1, None)]
    _, found = overdue(step(state, report(1, 1.0))[0], now_s=3.0, wait_s=1.0)
    assert times(found) == [(1.0, None, 0.9)]


def exchanges(skew_s: float, seed: int) -> list[Exchange]:
    """Questions to a room whose clock is ahead; the way back is the slower one."""
    random = np.random.default_rng(seed)
    asked = []
    for sent_s in np.arange(20.0):
        there, back = 0.001 + random.exponential(0.004), 0.002 + random.exponential(0.02)
        answered_s = float(sent_s + there)
        asked.append(Exchange(float(sent_s), answered_s + skew_s, float(answered_s + back)))
    return asked


def corrected_pairs(offset_s: float) -> list[Instant]:
    """Two viewers of one instant; viewer 2's clock is 200 ms behind the room's."""
    talk = []
    for n in range(40):
        talk.append(report(1, n * PERIOD_S, n))
        talk.append(report(2, n * PERIOD_S - 0.2 + offset_s, n))
    state, pairs = heard(init(PERIOD_S), talk)
    return pairs + flush(state)[1]


def frames_of(pairs: list[Instant]) -> list[tuple[int, int]]:
    """The frames' numbers of the pairs that are whole."""
    whole = (pair.views for pair in pairs if all(pair.views))
    return [(first.frame, second.frame) for first, second in whole if first and second]


@pytest.mark.parametrize("seed", range(5))
def test_viewers_whose_clocks_differ_by_200_ms_pair_after_correction_only(seed: int) -> None:
    state, offset = clock.init(), None
    for one in exchanges(0.2, seed):
        state, offset = clock.step(state, one)
    assert offset is not None
    assert frames_of(corrected_pairs(offset.offset_s)) == [(n, n) for n in range(40)]
    assert all(first != second for first, second in frames_of(corrected_pairs(0.0)))
