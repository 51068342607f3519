"""When the landmark network searches the whole picture, and what a frame hands to the next."""

from typing import Any

import msgspec
import numpy as np
import pytest

from common.body.observation import Landmarks
from common.config.settings import Settings
from viewer import landmark_step
from viewer.captured_frame import CapturedFrame
from viewer.landmark_step import State, step
from viewer.landmarks.own_landmarks import LandmarkResult
from viewer.silhouette.silhouette import Seen

EMPTY = Seen(np.zeros((12, 16), np.bool_), None, 0, 0, cut=False)
PERSON = Landmarks(((1.0, 2.0),) * 15, (0.9,) * 15)


def frame(captured_s: float, hurried: bool = False) -> CapturedFrame:
    picture = np.zeros((12, 16, 3), np.uint8)
    return CapturedFrame(0, captured_s, captured_s, picture, hurried=hurried)


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Of each call of the network, whether it searched the whole picture."""
    called: list[bool] = []

    def own(*_: Any, searches: bool) -> LandmarkResult:
        called.append(searches)
        return LandmarkResult(PERSON)

    monkeypatch.setattr(landmark_step, "own_landmarks", own)
    return called


def test_the_whole_picture_is_searched_at_once_and_then_twice_a_second(
    searches: list[bool],
) -> None:
    """At 10 frames a second every fifth."""
    state = State()
    for at in range(12):
        state, result = step(state, frame(at / 10 + 3.0), EMPTY, Settings(), alone=False)
        assert state.known is result.landmarks is PERSON
    assert searches == [at in (0, 5, 10) for at in range(12)]


def test_a_late_frame_of_a_single_view_is_not_searched_and_the_next_one_is(
    searches: list[bool],
) -> None:
    state, _ = step(State(), frame(3.0, hurried=True), EMPTY, Settings(), alone=True)
    step(state, frame(3.1), EMPTY, Settings(), alone=True)
    assert searches == [False, True]


def test_a_late_frame_of_two_views_keeps_what_is_known(searches: list[bool]) -> None:
    known = State(PERSON, 2.0)
    late = frame(9.0, hurried=True)
    assert step(known, late, EMPTY, Settings(), alone=False) == (known, LandmarkResult(None))
    assert searches == []


def test_an_outside_source_is_asked_in_a_hurry_too(searches: list[bool]) -> None:
    sent = msgspec.structs.replace(frame(9.0, hurried=True), landmarks=(PERSON,))
    settings = Settings(landmarks="mediapipe")
    state, result = step(State(), sent, EMPTY, settings, alone=False)
    assert (state.known, result.person) == (result.landmarks, None)
    assert searches == []
