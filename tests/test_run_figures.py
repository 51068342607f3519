"""The figures of a run, step by step: what was said in, counts and ages out."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.bus.control_messages import Pulse
from common.bus.inbox import Alive
from common.bus.messages import Body, Posture, Status
from runtime.outside.run_figures import BUCKETS_S, RunFigures, Told, step


def body(clock_s: float, status: Status = "tracking") -> Body:
    return Body(frame=0, captured_s=0.0, clock_s=clock_s, status=status, views="both")


def pulse(frames: int, state: str = "running") -> Pulse:
    return Pulse(process="viewer 1", state=state, frames=frames)  # type: ignore[arg-type]


def after(*told: Told, now_s: float = 100.0) -> RunFigures:
    figures = RunFigures()
    for one in told:
        figures = step(figures, one, now_s)
    return figures


def test_latency_is_from_capture_until_it_is_heard_and_falls_into_its_class() -> None:
    posture = Posture(frame=0, captured_s=0.0, clock_s=99.91, name="")
    figures = after(body(99.988), body(99.965), body(90.0), posture)
    bodies, postures = figures.latencies["integrator"], figures.latencies["recognizer"]
    assert bodies.sum_s == pytest.approx(0.012 + 0.035 + 10.0)
    assert [end for end, n in zip(BUCKETS_S, postures.counts, strict=False) if n] == [0.1]
    counted = dict(zip([*BUCKETS_S, "more"], bodies.counts, strict=True))
    assert {end for end, n in counted.items() if n} == {0.015, 0.04, "more"}


@given(st.lists(st.floats(0.0, 10.0), max_size=30))
def test_each_body_is_counted_in_one_class(took_s: list[float]) -> None:
    figures = after(*(body(100.0 - each) for each in took_s))
    counts = figures.latencies["integrator"].counts if took_s else ()
    assert sum(counts) == len(took_s) == sum(figures.bodies.values())


def test_bodies_are_counted_by_status() -> None:
    figures = after(body(99.0), body(99.0, "lost"), body(99.0))
    assert figures.bodies == {"tracking": 2, "lost": 1}


def test_a_long_runs_figures_are_of_the_people_whose_bodies_came_last() -> None:
    """Who comes in again has a new number: of a hundred, those of the last eight are kept."""
    told = [msgspec.structs.replace(body(99.0), person=n) for n in range(1, 101)]
    figures = after(*told, msgspec.structs.replace(body(99.0), person=95))
    assert [*figures.people] == [93, 94, 96, 97, 98, 99, 100, 95]
    assert figures.people[95].bodies == {"tracking": 2}


def test_a_process_whose_counts_begin_anew_is_another_one() -> None:
    told = [pulse(0, "starting"), pulse(0, "ready"), pulse(7), pulse(22)]
    assert after(*told).parts["viewer 1"].restarts == 0
    assert after(*told, pulse(0, "starting"), pulse(0, "ready")).parts["viewer 1"].restarts == 1
    assert after(*told, pulse(3)).parts["viewer 1"].restarts == 1, "its first pulses were missed"
    assert after(pulse(0), pulse(0, "starting")).parts["viewer 1"].restarts == 1


def test_who_goes_and_comes_is_known_whatever_it_says() -> None:
    here, gone = Alive("viewer 1", True), Alive("viewer 1", False)
    assert not after(pulse(3)).parts["viewer 1"].there
    assert after(here, pulse(3)).parts["viewer 1"].there
    assert not after(here, pulse(3), gone).parts["viewer 1"].there


def test_the_last_message_of_a_process_is_its_body_its_posture_or_its_pulse() -> None:
    figures = step(after(pulse(3), body(99.0)), pulse(4), 101.0)
    assert figures.parts["viewer 1"].heard_s == 101.0
    assert figures.parts["integrator"].heard_s == 100.0
