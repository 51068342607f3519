"""The page's words: what is likeliest comes first, and what was sent cannot become markup."""

import re
from typing import Any

import msgspec
import pytest

from animator.page.panel import (
    STATUS_WORDS,
    bar_shares,
    events_list,
    likelihood_bars,
    posture_headline,
    pulse_table,
    status_line,
    views_table,
)
from common.body.body import rest_pose
from common.bus.control_messages import Pulse
from common.bus.messages import Body, Performance, Posture, Report, Status

LIKELIHOODS = {"squat": -90.5, "walk_in_place": -61.25, "kick_left_side": -140.0}


def posture(name: str = "walk_in_place") -> Posture:
    return Posture(
        frame=41,
        captured_s=2.7,
        clock_s=0.0,
        name=name,
        log_likelihoods=LIKELIHOODS,
        segment=(2, 41),
    )


def body(status: Status = "tracking") -> Body:
    return Body(
        frame=41,
        captured_s=2.73,
        clock_s=0.0,
        status=status,
        views="both",
        pose=tuple(rest_pose()),
        score=(0.83, 0.71),
        facing=("facade", "flank"),
    )


def report(**told: Any) -> Report:
    return Report(
        frame=41,
        captured_s=2.7,
        clock_s=0.0,
        viewer=1,
        width=8,
        height=1,
        silhouette=b"\0",
        box=None,
        **told,
    )


def test_postures_are_listed_from_the_likeliest_down() -> None:
    html = likelihood_bars(posture())
    places = [html.index(name) for name in ("walk in place", "squat", "kick left side")]
    assert places == sorted(places)
    assert "frames 2 to 41" in html


def test_the_best_bar_is_full_and_the_middle_one_half() -> None:
    assert bar_shares([-10.0, -20.0, -30.0, -50.0, -1000.0]) == [1.0, 0.75, 0.5, 0.0, 0.0]


@pytest.mark.parametrize("ranked", [[-7.0], [-7.0, -7.0, -7.0]], ids=["one", "all alike"])
def test_bars_of_equals_are_all_full(ranked: list[float]) -> None:
    assert bar_shares(ranked) == [1.0] * len(ranked)


def test_a_posture_that_is_not_known_yet_is_said_to_be_so() -> None:
    assert "no posture yet" in posture_headline(None)
    assert "no posture yet" in posture_headline(posture(name=""))
    assert "walk in place" in posture_headline(posture())


def test_what_is_under_way_stands_in_the_headline_with_its_repetitions() -> None:
    under_way = msgspec.structs.replace(posture("squat"), doing="kick_left_side", times=2)
    assert "kick left side × 2" in posture_headline(under_way)
    assert "squat" not in posture_headline(under_way)


def test_performances_that_are_over_are_listed_from_the_newest() -> None:
    over = [
        Performance("squat", 30, 60, 2.0, 4.0, 1.0, 1),
        Performance("walk_in_place", 90, 150, 6.0, 10.0, 1.0, 3),
    ]
    html = events_list(over)
    assert html.index("walk in place × 3") < html.index("squat")
    assert "2.0 to 4.0 s" in html
    assert events_list([]) == ""
    assert "<img" not in events_list([msgspec.structs.replace(over[0], name="<img src=x>")])


def test_names_from_the_bus_cannot_become_markup() -> None:
    evil = '<img src=x onerror="alert(1)">'
    pulse = Pulse(process=evil, state="running", detail=f'">{evil}')
    named = Posture(frame=0, captured_s=0.0, clock_s=0.0, name=evil, log_likelihoods={evil: -1.0})
    for html in (posture_headline(named), likelihood_bars(named), pulse_table([pulse])):
        assert "<img" not in html


def test_each_view_says_what_it_sees_and_its_score() -> None:
    html = views_table(body(), {}, 2)
    assert re.search("camera 1: front or back.*0.83.*camera 2: side.*0.71", html, re.DOTALL)
    assert "camera 2" not in views_table(body(), {}, 1)
    assert "front" not in views_table(None, {}, 2)


def test_the_person_is_told_what_is_in_the_way() -> None:
    """The refusal of the opening posture matters while the body is being measured, not later."""
    refused = report(refusal="raise both arms <sideways>")
    told = "raise both arms &lt;sideways&gt;"
    assert told in views_table(body("measuring"), {1: refused}, 1)
    assert told not in views_table(body("tracking"), {1: refused}, 1)
    assert "partly outside" in views_table(body(), {1: report(cut=True)}, 1)
    assert "nothing heard" in views_table(body(), {}, 1)


@pytest.mark.parametrize("status", STATUS_WORDS)
def test_every_status_has_words_for_a_newcomer(status: Status) -> None:
    assert STATUS_WORDS[status][0] in status_line(body(status), [])


def test_the_line_tells_the_slowest_rate_and_the_longest_latency() -> None:
    """A chain is as fast as its slowest part, and what is shown is as old as its last part."""
    pulses = [
        Pulse(process="viewer 1", state="running", fps=14.9, latency_p50_ms=4.0),
        Pulse(process="animator", state="running", fps=12.1, latency_p50_ms=31.0),
        Pulse(process="viewer 2", state="ended", fps=0.0, latency_p50_ms=99.0),
    ]
    line = status_line(body(), pulses)
    assert "frame 41 · 2.7 s · 12.1 fps · 31 ms latency" in line
    assert "fps" not in status_line(body(), [])
