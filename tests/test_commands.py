"""What the person at the page asks of the integrator, on people whose pose is known."""

import pytest
from staging import NOBODY, PERIOD_S, RIG, Stage, exact, opening, silhouettes, standing

from common.bus.control_messages import Command, Wish
from common.config.settings import Settings
from common.method import DEFAULT
from integrator import commands, merge_state
from integrator.measuring.known_body import Measured, Unmeasured
from integrator.single.sight import Annotations


def test_a_body_is_measured_again_and_keeps_its_lengths_until_then(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    exact(monkeypatch)
    stage = Stage()
    stage.show([opening()] * 12)
    measured = stage.state.person.body
    assert isinstance(measured, Measured)
    state, _, answer = commands.step(stage.state, Annotations(), Command(what="measure"))
    assert answer is not None
    assert answer.well
    assert state.person.body == Unmeasured(measured.bdp)
    stage.state = state
    told = stage.show([standing()] * 2)
    assert not told[-1].guide.measured, "the viewers look for the opening posture again"
    stage.show([opening()] * 12)
    assert isinstance(stage.state.person.body, Measured)


def test_front_and_back_are_for_one_camera_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    exact(monkeypatch)
    stage = Stage()
    stage.show([standing()] * 3)
    _, said, answer = commands.step(stage.state, Annotations(), Command(what="back"))
    assert said == Annotations()
    assert answer is not None
    assert not answer.well


def test_somebody_whom_one_camera_sees_is_turned_about(monkeypatch: pytest.MonkeyPatch) -> None:
    """The word holds on: it is remembered until the person turns through their side."""
    exact(monkeypatch)
    stage = Stage(views=(1,))
    seen = (silhouettes(standing())[0], None)
    for _ in range(4):
        before = stage.see(seen).body.lifting
    assert before is not None
    asked: Wish = "front" if before.orientation.startswith("backward") else "back"
    state, said, answer = commands.step(stage.state, Annotations(), Command(what=asked))
    assert answer is not None
    assert answer.well
    assert said.orientation is not None
    assert said.orientation.startswith("forward" if asked == "front" else "backward")
    assert state is stage.state


def test_what_is_for_others_is_not_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    exact(monkeypatch)
    stage = Stage()
    stage.see((NOBODY, NOBODY))
    others: tuple[Wish, ...] = ("start", "stop", "record", "save", "background")
    for what in others:
        assert commands.step(stage.state, Annotations(), Command(what=what))[2] is None


def test_what_is_for_others_changes_and_answers_nothing() -> None:
    """State and what was said come back as they were, each in its place."""
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
    said = Annotations(orientation="left")
    found = commands.step(state, said, Command(what="record"))
    assert found[0] is state
    assert found[1] is said
    assert found[2] is None
