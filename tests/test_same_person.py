"""One person in all views: a view that turns to another person is left out until it is back."""

from collections.abc import Callable

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray
from staging import RIG
from test_rig_agreement import turned
from two_people import first_m, instant, other_m, seen

from calibration.gate.sight_clash import LATEST
from common.bus.instant import Instant
from integrator.rig.same_person import GONE, Expected, State, of_person, step
from runtime.unfinished.state_codec import packed, unpacked

LASTING = 5
AT_M = np.array([0.0, 0.9, 0.0])


Acts = Callable[[int], NDArray[np.float64]]


def run(
    n: range,
    views: tuple[Acts, Acts],
    state: State = State(),
    at_m: NDArray[np.float64] | None = AT_M,
    sure: float = 0.9,
) -> State:
    """Instants in which each view shows the person of a function of time."""
    for k in n:
        shown = instant(k, (seen(0, views[0](k)),), (seen(1, views[1](k), sure),))
        state = step(state, RIG, shown, Expected(at_m, LASTING))
    return state


@pytest.mark.parametrize(("views", "kept"), [((first_m, other_m), 0), ((other_m, first_m), 1)])
def test_the_view_that_shows_the_expected_person_is_kept(
    views: tuple[Acts, Acts], kept: int
) -> None:
    state = run(range(30, 36), views, run(range(30), (first_m, first_m)))
    assert state.is_apart
    assert state.chosen == ((0, -1), (-1, 0))[kept]
    assert state.left_out == ((0, 2), (2, 0))[kept]
    assert state.since_s == pytest.approx(34 / 15)


def test_a_single_bad_frame_changes_nothing() -> None:
    before = run(range(30), (first_m, first_m))
    state = run(range(30, 31), (first_m, other_m), before)
    assert (state.chosen, state.left_out) == ((0, 0), (0, 0))


def test_a_view_that_is_back_counts_again_after_as_long_and_its_absence_is_remembered() -> None:
    state = run(range(30, 40), (first_m, other_m), run(range(30), (first_m, first_m)))
    state = run(range(40, 44), (first_m, first_m), state)
    assert state.chosen == (0, -1)
    state = run(range(44, 45), (first_m, first_m), state)
    assert (state.chosen, state.is_apart) == ((0, 0), False)
    assert state.left_out == (0, 10)


def test_a_view_that_was_left_out_counts_again_once_the_kept_one_shows_no_person_for_long() -> None:
    state = run(range(30, 40), (first_m, other_m), run(range(30), (first_m, first_m)))
    assert state.chosen == (0, -1)
    for k in range(40, 40 + GONE * LASTING):
        shown = instant(k, (), (seen(1, other_m(k)),))
        state = step(state, RIG, shown, Expected(None, LASTING))
        assert state.chosen == (-1, -1)
    shown = instant(99, (), (seen(1, other_m(99)),))
    assert step(state, RIG, shown, Expected(None, LASTING)).chosen == (-1, 0)


def test_what_turns_out_to_be_the_rig_is_not_remembered_as_different_people() -> None:
    """Camera 2 is lowered by half a metre, which its picture did not show."""
    wrong = turned(RIG, 0.0, 0.5)
    state = run(range(30), (first_m, first_m))
    for k in range(30, 45 + LATEST):
        shown = instant(k, (seen(0, first_m(k)),), (seen(1, first_m(k)),))
        state = step(state, wrong, shown, Expected(AT_M, LASTING))
        if k == 40:
            assert (state.is_apart, sum(state.left_out) > 0) == (True, True)
    assert (state.is_apart, state.left_out, state.since_s) == (False, (0, 0), None)


def test_at_the_start_the_surer_view_is_kept() -> None:
    state = run(range(40), (first_m, other_m), at_m=None, sure=0.95)
    assert state.chosen == (-1, 0)
    state = run(range(40), (first_m, other_m), at_m=None, sure=0.8)
    assert state.chosen == (0, -1)


def test_of_three_views_the_one_apart_from_both_others_is_left_out() -> None:
    rig = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    state = State()
    for n in range(40):
        views = [first_m, first_m, first_m if n < 20 else other_m]
        people = [(seen(k, view(n), rig=rig),) for k, view in enumerate(views)]
        state = step(state, rig, instant(n, *people), Expected(AT_M, LASTING))
    assert state.chosen == (0, 0, -1)


def test_a_single_camera_has_nothing_to_compare() -> None:
    rig = msgspec.structs.replace(RIG, cameras=RIG.cameras[:1])
    state = step(State(), rig, instant(0, (seen(0, first_m(0)),)), Expected(None, LASTING))
    assert (state.chosen, state.is_apart, state.met) == ((0,), False, 0)


def test_the_chosen_person_is_the_first_of_a_view_and_others_come_after() -> None:
    one, two = seen(0, first_m(0)), seen(0, other_m(0))
    shown = instant(0, (one, two), (one, two))
    found = of_person(shown, (1, -1))
    assert [view.people for view in found.views if view is not None] == [(two, one), ()]
    assert of_person(shown, (0, 0)) is shown
    assert of_person(shown, ()) is shown
    assert of_person(Instant((None, shown.views[1])), (-1, 1)).views[0] is None


def test_the_evidence_is_read_back_as_it_was_saved() -> None:
    state = run(range(30, 36), (first_m, other_m), run(range(30), (first_m, first_m)))
    read = unpacked(packed(state), State)
    assert packed(read) == packed(state)
    assert run(range(36, 40), (first_m, other_m), read).chosen == (0, -1)
