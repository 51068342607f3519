"""The sliding window, held against the scores of the same frames taken as a whole."""

import numpy as np
import pytest
from acting import perform, performances, standing

from lab.posture_models.learning import train
from recognizer.features import ROW_NAMES
from recognizer.postures import POSTURES, PostureModel, Recognizer, log_likelihoods
from recognizer.spotting import Judgement, State, init, step

WINDOW = 40
JITTER = np.repeat([1.0, 0.003], [17, 3])
"""Of a person who stands: degrees, then leg lengths."""


RECOGNIZERS: list[Recognizer] = ["default", "paper"]


@pytest.fixture(scope="module", params=RECOGNIZERS)
def model(request: pytest.FixtureRequest) -> PostureModel:
    return train(performances(range(6)), request.param)


def watch(model: PostureModel, rows: list[np.ndarray | None]) -> list[Judgement]:
    state, said = init(model, WINDOW), []
    for row in rows:
        state, judgement = step(state, row)
        said.append(judgement)
    return said


def test_each_judgement_is_that_of_its_frames_taken_as_a_whole(model: PostureModel) -> None:
    """P58, on the frames from `first` to `last`."""
    angles_deg = perform("walk_toward", performer=9, frames=70)
    for frame, judgement in enumerate(watch(model, list(angles_deg))):
        assert judgement.last == frame
        assert judgement.first == max(0, frame - WINDOW + 1)
        if judgement.name:
            whole = log_likelihoods(model, angles_deg[judgement.first : judgement.last + 1])
            assert judgement.log_likelihoods == pytest.approx(whole, abs=1e-9)
            assert judgement.name == max(whole, key=lambda posture: whole[posture])


def test_a_name_needs_a_second_of_motion(model: PostureModel) -> None:
    """15 frames, at the paper's 15 a second."""
    said = watch(model, list(perform("walk_toward", performer=9)))
    assert [one.name != "" for one in said] == [frame >= 14 for frame in range(40)]
    assert said[0].log_likelihoods == {}


def test_standing_has_no_name(model: PostureModel) -> None:
    shaking = standing(100) + np.random.default_rng(0).normal(0.0, 1.0, (100, 20)) * JITTER
    assert {one.name for one in watch(model, list(shaking))} == {""}


@pytest.mark.parametrize("posture", list(POSTURES))
def test_what_came_before_a_standstill_is_left_out(model: PostureModel, posture: str) -> None:
    """The opening posture, then a motion: the window begins where the motion did."""
    opening = 14  # frames, as in the development clips
    said = watch(model, [*standing(opening), *perform(posture, performer=9, frames=30)])
    assert all(one.name == "" for one in said[:opening])
    assert said[-1].name == posture
    assert opening <= said[-1].first <= opening + 10
    assert said[-1].last == opening + 29


def test_a_pause_of_half_a_second_belongs_to_the_motion(model: PostureModel) -> None:
    squat = perform("squat", performer=9, frames=20)
    said = watch(model, [*squat[:14], *standing(8), *squat[:14]])
    assert said[-1].first == 0


def test_a_motion_that_ends_in_standing_keeps_its_name_while_it_is_in_the_window(
    model: PostureModel,
) -> None:
    said = watch(model, [*perform("squat", performer=9), *standing(60)])
    assert {one.name for one in said[39:60]} == {"squat"}
    assert said[-1].name == ""


def test_frames_without_a_pose_add_nothing(model: PostureModel) -> None:
    rows: list[np.ndarray | None] = list(perform("squat", performer=9))
    nowhere = np.full(len(ROW_NAMES), np.nan)
    said = watch(model, [*rows[:20], None, nowhere, *rows[20:]])
    plain = watch(model, rows)
    assert said[21].log_likelihoods == plain[19].log_likelihoods
    assert said[21].last == 19
    assert said[-1].log_likelihoods == plain[-1].log_likelihoods
    assert (said[-1].first, said[-1].last) == (0, 41)


def test_a_second_without_a_pose_begins_anew(model: PostureModel) -> None:
    rows = list(perform("squat", performer=9))
    said = watch(model, [*rows, *[None] * 15, *rows])
    assert said[53].name == "squat"
    assert (said[54].name, said[54].first, said[54].last) == ("", 54, 54)
    assert said[55].first == 55
    assert said[-1].log_likelihoods == watch(model, rows)[-1].log_likelihoods


def test_a_step_leaves_the_state_it_was_given_alone(model: PostureModel) -> None:
    rows = perform("squat", performer=9)
    state: State = init(model, WINDOW)
    for row in rows[:30]:
        state, _ = step(state, row)
    _, first = step(state, rows[30])
    _, again = step(state, rows[30])
    assert first == again


def test_a_short_window_names_when_it_is_full(model: PostureModel) -> None:
    """The least that the settings allow is 5 frames."""
    state, names = init(model, 5), []
    for row in perform("swing_right_circles", performer=9):
        state, judgement = step(state, row)
        names.append(judgement.name)
        assert judgement.last - judgement.first < 5
    assert names[3] == ""
    assert names[4] != ""
