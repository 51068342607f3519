"""When a live run asks which camera is odd, of what it has seen."""

from typing import Any

import numpy as np
import pytest
from many_views import around, shown
from sights_as_views import instants_of, without
from staging import changed

from calibration.gate.odd_camera import OddCamera
from common.bus.instant import Instant
from integrator.live_rig import odd_search
from integrator.live_rig.odd_job import NONE_ODD, OddJob
from integrator.live_rig.odd_search import ASKS_S, MOST_PEOPLE, MOST_ROWS, MOST_TURNS, State
from integrator.live_rig.rig_job import track_of_bytes

RIG = around(3)
SHOWN = shown(RIG, 11, "walk_toward")
ODD = OddCamera(1, (0.05, 0.0, 0.0), 0.06, 0.01)
HZ = 15


def after(
    state: State, instants: list[Instant], people: tuple[int, ...] = (0,)
) -> tuple[State, list[OddJob]]:
    """The state after instants that show the same of each person; requests are answered."""
    jobs = []
    for instant in instants:
        views = {view.viewer: view for view in instant.views if view is not None}
        state, job = odd_search.step(state, RIG, dict.fromkeys(people, views), 1 / HZ)
        if job is not None:
            jobs.append(job)
            state, _ = odd_search.answered(state, NONE_ODD)
    return state, jobs


def test_it_is_asked_as_the_table_says_of_all_that_was_seen_and_nothing_is_kept_then() -> None:
    state, jobs = after(State(0), instants_of(SHOWN, ASKS_S[-1] + 5.0))
    lasts = [[len(track_of_bytes(view).times_s) / HZ for view in job.people[0]] for job in jobs]
    assert lasts == [[pytest.approx(at_s, abs=0.1)] * 3 for at_s in ASKS_S]
    assert jobs[0].rig == RIG
    assert state.is_over
    assert state.rows == {}


def test_a_request_has_what_each_view_showed() -> None:
    _, (job,) = after(State(0), instants_of(SHOWN, ASKS_S[0] + 1.0))
    for told, track in zip(job.people[0], SHOWN.tracks, strict=True):
        found = track_of_bytes(told)
        np.testing.assert_allclose(found.joints_px[:20], track.joints_px[:20])
        assert found.times_s[:3] == pytest.approx([0.0, 1 / HZ, 2 / HZ])


def test_who_is_seen_by_one_view_alone_is_no_evidence() -> None:
    alone = [without(instant, (1, 3)) for instant in instants_of(SHOWN, ASKS_S[0] + 5.0)]
    state, jobs = after(State(0), alone)
    assert (jobs, state.shown_s, state.rows) == ([], 0.0, {})
    by_two = [without(instant, (3,)) for instant in instants_of(SHOWN, ASKS_S[0] + 1.0)]
    assert len(after(State(0), by_two)[1]) == 1


@pytest.mark.parametrize("told", [{"landmarks": None}, {"carried": True}])
def test_frames_that_came_too_late_to_be_looked_into_are_no_evidence(told: dict[str, Any]) -> None:
    late = [
        Instant(tuple(changed(view, **told) for view in instant.views if view is not None))
        for instant in instants_of(SHOWN, ASKS_S[0] + 1.0)
    ]
    assert after(State(0), late) == (State(0, last_s=(11.0 - 1 / HZ,) * 3), [])


def test_nothing_is_asked_while_an_answer_is_awaited() -> None:
    state = State(0)
    jobs = []
    for instant in instants_of(SHOWN, ASKS_S[1] + 2.0):
        views = {view.viewer: view for view in instant.views if view is not None}
        state, job = odd_search.step(state, RIG, {0: views}, 1 / HZ)
        jobs += [] if job is None else [job]
    assert len(jobs) == 1
    assert state.waits


def test_a_view_that_is_repeated_counts_once() -> None:
    (instant,) = instants_of(SHOWN, 1 / HZ)
    state, _ = after(State(0), [instant, instant])
    assert [len(view) for view in state.rows[0]] == [1, 1, 1]


def test_the_memory_is_bounded_in_people_and_in_rows() -> None:
    few = instants_of(SHOWN, 0.2)
    state, _ = after(State(0), few, people=tuple(range(1, MOST_PEOPLE + 4)))
    assert len(state.rows) == MOST_PEOPLE
    (instant,) = instants_of(SHOWN, 1 / HZ)
    full = ((b"",) * MOST_ROWS,) * 3
    state, _ = after(State(0, rows={4: full}), [instant], people=(4,))
    assert [len(view) for view in state.rows[4]] == [MOST_ROWS] * 3


def test_of_too_many_people_those_seen_least_are_left_out() -> None:
    long, (last,) = instants_of(SHOWN, 1.0), instants_of(SHOWN, 16 / HZ)[-1:]
    state, _ = after(State(0), long, people=tuple(range(1, MOST_PEOPLE + 1)))
    state, _ = after(state, [last], people=(99,))
    assert 99 not in state.rows


def test_a_camera_is_turned_by_an_answer_about_the_rig_in_use_alone() -> None:
    state, found = odd_search.answered(State(0, waits=True), ODD)
    assert (found, state.turns, state.waits) == (ODD, 1, False)
    stale = odd_search.anew(State(0, waits=True, turns=1), 1)
    state, found = odd_search.answered(stale, ODD)
    assert (found, state.turns, state.waits, state.is_stale) == (None, 1, False, False)
    assert odd_search.answered(state._replace(waits=True), ODD)[1] == ODD


def test_a_new_rig_has_its_own_evidence() -> None:
    state, _ = after(State(0), instants_of(SHOWN, 5.0))
    again = odd_search.anew(state, 1)
    assert (again.calibration, again.rows, again.shown_s, again.asked) == (1, {}, 0.0, 0)
    assert again.last_s == state.last_s


def test_a_run_turns_no_more_cameras_than_the_bound() -> None:
    state = State(0, turns=MOST_TURNS)
    assert after(state, instants_of(SHOWN, ASKS_S[0] + 1.0)) == (state, [])
