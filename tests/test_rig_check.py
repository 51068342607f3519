"""What a run says of its calibration."""

from typing import Any

import pytest

from common.bus.messages import Body
from common.video.clip_facts import Clip, Meta, View
from integrator.selfcalibration.lateness import UNSEEN, Clock
from tritrack.offline.rig_check import (
    DOUBTED,
    clock_facts,
    clock_word,
    doubted,
    doubts,
    is_late,
)

TRUST = {
    "apart_mm": 61.4,
    "apart_px": 2.6,
    "soles_mm": -80.2,
    "stature_m": 1.86,
    "late_frames": 0.2,
    "facing_deg": 3.2,
    "motion_mm": 21.4,
    "advice": "camera 2 seems turned by 8 degrees against camera 1: calibrate again",
}


@pytest.mark.parametrize("facts", [{}, {"trust": {**TRUST, "advice": ""}}])
def test_a_run_that_is_believable_or_cannot_tell_says_nothing(facts: dict[str, Any]) -> None:
    assert doubts(facts) == []


def test_a_run_that_is_not_believable_says_what_is_wrong_and_what_to_do_in_one_line() -> None:
    (told,) = doubts({"trust": TRUST})
    assert "views 61 mm (2.6 px) apart, soles -80 mm over the floor" in told
    assert "facings 3 degrees apart, motions 21 mm" in told
    assert "camera 2 seems turned by 8 degrees against camera 1: calibrate again" in told


def two_views(late_s: float = 0.0) -> Clip:
    size = (160, 120)
    views = tuple(
        View(number, f"cam{number}.avi", size, size, 15.0, 60, late_s=late_s * (number == 2))
        for number in (1, 2)
    )
    return Clip("late", views, 1, None, Meta())


def test_a_clock_that_was_set_is_told_with_the_seconds() -> None:
    facts = clock_facts(two_views(-0.4), Clock(-0.4), None)
    assert facts == {
        "clock": {"state": "found", "applied_s": -0.4, "may_be_s": [], "may_be_on_time": True}
    }
    assert clock_word(facts) == "view 2 is -0.40 s late: its times were set back by that"


def test_a_clock_that_is_right_or_shown_by_nobody_is_not_spoken_of() -> None:
    assert clock_word(clock_facts(two_views(), Clock(0.02), None)) == ""
    assert clock_word(clock_facts(two_views(), UNSEEN, None)) == ""
    assert clock_word({}) == ""


def test_a_gait_that_repeats_itself_is_said_with_all_that_may_be() -> None:
    facts = clock_facts(two_views(), Clock(0.5, (-0.5, 1.5), False), None)
    assert facts["clock"]["may_be_s"] == [-0.5, 0.5, 1.5]
    word = clock_word(facts)
    assert "(-0.50, +0.50, +1.50 s)" in word
    assert "hardly believed; say it by --offset SECONDS" in word
    on_time = clock_facts(two_views(), Clock(0.5, (0.0,)), None)
    assert on_time["clock"]["may_be_s"] == [0.0, 0.5]
    assert clock_word(on_time) == "", "a good walk is no reason for a warning"


def test_an_offset_that_is_given_is_not_ambiguous() -> None:
    facts = clock_facts(two_views(0.5), Clock(0.0, (1.0,)), 0.5)
    assert facts == {
        "clock": {"state": "given", "applied_s": 0.5, "may_be_s": [], "may_be_on_time": True}
    }


@pytest.mark.parametrize(
    ("clock", "late"),
    [
        (Clock(0.06), True),
        (Clock(-0.06), True),
        (Clock(0.04), False),
        (Clock(2.0, (3.0,)), False),
        (UNSEEN, False),
    ],
)
def test_a_clip_is_tracked_again_where_its_clock_is_found_to_be_off(
    clock: Clock, late: bool
) -> None:
    assert is_late(two_views(), clock) is late


def test_bodies_of_a_view_that_is_late_by_nobody_knows_how_much_are_hardly_believed() -> None:
    body = Body(
        frame=0, captured_s=0.0, clock_s=0.0, status="tracking", views="both", confidence=(0.9, 0.4)
    )
    (left,) = doubted([body], Clock(1.0, (2.0,), False))
    assert left.confidence == pytest.approx((0.9 * DOUBTED, 0.4 * DOUBTED))
    assert doubted([body], Clock(1.0, (0.1,))) == [body]
    assert doubted([body], UNSEEN) == [body]
    assert doubted([body], Clock(0.05, (), False)) == [body], "found, and less than a frame"
