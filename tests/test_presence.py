"""Views that are lost and found: why, how soon it is said, and how long they are waited for."""

import pytest
from staging import report

from common.bus.control_messages import Ended
from common.bus.messages import CameraFault, ViewerNumber
from integrator.presence import (
    GONE_S,
    MOST_NEWS,
    State,
    came,
    ended,
    going,
    heard,
    init,
    step,
    went,
)

PERIOD_S = 1 / 15


def running(until_s: float = 10.0, viewers: tuple[ViewerNumber, ...] = (1, 2)) -> State:
    """Both report frame after frame."""
    state = init(PERIOD_S, viewers)
    for frame in range(round(until_s / PERIOD_S) + 1):
        state = hear(state, frame * PERIOD_S, viewers)
    assert state.news == ()
    return state


def hear(
    state: State,
    now_s: float,
    viewers: tuple[ViewerNumber, ...] = (1,),
    fault: CameraFault = "",
) -> State:
    for viewer in viewers:
        state = heard(state, report(viewer, fault=fault), now_s)
    return step(state, now_s)[0]


def test_a_viewer_that_is_killed_is_told_within_a_second() -> None:
    """Zenoh tells of a closed link within milliseconds."""
    state = hear(went(running(), 2, 10.0), 10.2)
    assert step(state, 10.3)[1] == [
        "10.3 s: view 2 is lost (it was killed, or its link is cut); view 1 goes on alone"
    ]


def test_a_viewer_that_ends_may_leave_the_bus_before_its_last_word_is_heard() -> None:
    state = step(went(running(), 2, 10.0), 10.1)[0]
    state = ended(hear(state, 10.1), Ended(viewer=2, frames=150), 10.2)
    state = ended(step(state, 10.2)[0], Ended(viewer=1, frames=150), 10.25)
    assert step(state, 10.3)[1] == []


def test_silence_is_told_within_a_second_by_the_rate_of_the_reports() -> None:
    """Issue 5, step 7: a frozen viewer keeps its place on the bus for a while."""
    state, told_s = running(), []
    for frame in range(1, 16):
        now_s = 10.0 + frame * PERIOD_S
        before = state.news
        state = hear(state, now_s)
        told_s += [now_s - 10.0] if state.news != before else []
    assert len(told_s) == 1
    assert 5 * PERIOD_S < told_s[0] < 0.5
    assert "view 2 is lost (it says nothing: it hangs, or its camera" in state.news[0]


def test_a_rate_of_its_own_has_a_silence_of_its_own() -> None:
    """At one frame a second a pause of half a second is none."""
    state = init(1.0, (1, 2))
    for second in range(5):
        state = hear(state, float(second), (1, 2))
    assert step(state, 6.0)[1] == []


@pytest.mark.parametrize("fault", ["frozen", "black", "saturated", "covered"])
def test_a_useless_picture_is_told_and_its_end_too(fault: CameraFault) -> None:
    state = hear(running(), 10.1, (2,), fault)
    assert f"view 2 is lost (its camera's picture is {fault})" in state.news[-1]
    assert hear(state, 10.2, (1, 2)).news[-1] == "10.2 s: view 2 is back"


def test_a_loss_is_told_once_whatever_else_becomes_of_it() -> None:
    """A viewer that hangs falls off the bus a second later."""
    state = hear(hear(running(), 10.3), 10.5)
    state = hear(went(state, 2, 11.0), 11.5)
    assert len(state.news) == 1


def test_a_viewer_that_is_started_again_is_back_when_it_reports() -> None:
    state = hear(went(running(), 2, 10.0), 10.5)
    state = hear(came(state, 2, 14.0), 15.0)
    assert len(state.news) == 1
    assert hear(state, 15.1, (1, 2)).news[-1] == "15.1 s: view 2 is back"


def test_without_any_view_nobody_looks() -> None:
    state = hear(went(running(), 2, 10.0), 10.3)
    told = step(went(state, 1, 10.3), 10.6)[1]
    assert told == ["10.6 s: view 1 is lost (it was killed, or its link is cut); nobody looks now"]
    alone = went(running(viewers=(1,)), 1, 10.3)
    assert step(alone, 10.6)[1] == told


def test_a_viewer_that_is_no_part_of_the_run_is_not_missed() -> None:
    state = running(viewers=(2,))
    assert step(hear(state, 11.0, (2,)), 11.0)[1] == []
    assert going(state, 11.0)


def test_two_clips_that_end_together_are_no_loss_and_one_that_ends_early_is() -> None:
    state = ended(running(), Ended(viewer=2, frames=150), 10.0)
    assert step(state, 10.2)[1] == []
    both = ended(state, Ended(viewer=1, frames=150), 10.3)
    assert not going(both, 10.3)
    assert step(both, 20.0)[1] == []
    assert "view 2 is lost (its clip is over); view 1" in hear(state, 10.6).news[0]


def test_a_video_that_broke_is_named() -> None:
    state = ended(running(), Ended(viewer=2, frames=7, why="cam2.avi broke the decoder"), 10.0)
    assert "view 2 is lost (cam2.avi broke the decoder)" in hear(state, 10.6).news[0]


def test_an_only_video_that_broke_may_go_on() -> None:
    """Its viewer is started again: a run that ended by its last word would hear none of that."""
    state = ended(running(viewers=(1,)), Ended(viewer=1, frames=7, why="it broke"), 10.0)
    state = went(state, 1, 10.1)
    assert going(state, 10.0 + GONE_S)
    assert not going(state, 10.1 + GONE_S)
    again = hear(came(state, 1, 12.0), 12.1)
    assert going(again, 200.0)
    assert not going(ended(again, Ended(viewer=1, frames=150), 20.0), 20.0)


def test_nobody_waits_for_ever_for_a_viewer_that_was_killed() -> None:
    """The other one has ended; after a minute nobody comes any more."""
    state = ended(running(), Ended(viewer=1, frames=150), 10.0)
    state = went(state, 2, 10.0)
    assert going(state, 10.0 + GONE_S)
    assert not going(state, 10.1 + GONE_S)
    assert going(came(state, 2, 60.0), 10.1 + GONE_S)


def test_a_run_is_not_over_before_it_has_begun() -> None:
    state = init(PERIOD_S, (1, 2))
    assert going(state, 1e6)
    assert step(state, 1e6) == (state, [])


def test_a_link_that_flickers_fills_no_log() -> None:
    state = running()
    for second in range(11, 80):
        state = hear(went(state, 2, second), second + 0.3)
        state = hear(state, second + 0.5, (1, 2))
    assert len(state.news) == MOST_NEWS
