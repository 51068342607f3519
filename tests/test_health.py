"""Whether a run is well: each thing that can be wrong is named with what to do."""

import re

import pytest

from common.bus.control_messages import Pulse
from common.bus.inbox import Alive
from common.bus.messages import Body
from runtime.outside.health import ailments
from runtime.outside.run_figures import RunFigures, Told, step

NEEDED = ("integrator", "viewer 1")
START_S = 100.0


def pulse(name: str, state: str = "running", frames: int = 9) -> Pulse:
    return Pulse(process=name, state=state, frames=frames)  # type: ignore[arg-type]


BODY = Body(frame=9, captured_s=0.6, clock_s=99.9, status="tracking", views="both")
WORKING: tuple[Told, ...] = (
    *(Alive(name, True) for name in NEEDED),
    *(pulse(name) for name in NEEDED),
    BODY,
)


def wrong(*told: Told, later_s: float = 1.0) -> list[str]:
    figures = RunFigures()
    for one in told:
        figures = step(figures, one, START_S)
    return ailments(figures, NEEDED, START_S + later_s)


def test_a_run_whose_processes_are_there_and_young_is_well() -> None:
    assert wrong(*WORKING) == []


def test_what_was_never_heard_is_waited_for() -> None:
    assert [re.sub(";.*", "", line) for line in wrong()] == [
        f"{name}: not heard yet" for name in NEEDED
    ]


def test_a_process_that_is_gone_is_named_until_another_has_its_place() -> None:
    gone = (*WORKING, Alive("viewer 1", False))
    (line,) = wrong(*gone)
    assert line.startswith("viewer 1: it is gone")
    assert "log.txt" in line
    begins = (*gone, pulse("viewer 1", "starting", 0))
    assert re.match("viewer 1: it starts", wrong(*begins)[0])
    ready = (*begins, Alive("viewer 1", True), pulse("viewer 1", "ready", 0))
    assert wrong(*ready) == []


def test_a_process_that_says_nothing_hangs() -> None:
    lines = wrong(*WORKING, later_s=6.0)
    assert [line.partition(" and")[0] for line in lines] == [
        f"{name}: it has said nothing for 6 s" for name in NEEDED
    ]


def test_bodies_that_cease_are_told_where_all_processes_live() -> None:
    (line,) = wrong(*WORKING, later_s=3.0)
    assert line.startswith("no body for 3 s: look whether the cameras give pictures")


@pytest.mark.parametrize("state", ["ready", "ended"])
def test_a_run_that_waits_for_its_page_or_is_over_is_well(state: str) -> None:
    told = [message for message in WORKING if not isinstance(message, Pulse | Body)]
    assert wrong(*told, *(pulse(name, state) for name in NEEDED), later_s=30.0) == []


def test_a_viewer_whose_clip_is_over_may_go() -> None:
    assert wrong(*WORKING, pulse("viewer 1", "ended"), Alive("viewer 1", False)) == []
