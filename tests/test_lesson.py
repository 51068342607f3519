"""A posture that few takes teach: known again, told apart, and nothing else changed."""

import numpy as np
import pytest
from acting import perform

from recognizer.learning_error import LearningError
from recognizer.postures import PostureModel, name
from recognizer.training.learning import train
from recognizer.training.lesson import taught

KNOWN = ("squat", "raise_right_lateral", "walk_toward")
NEW = "kick_left_side"


@pytest.fixture(scope="module")
def known() -> PostureModel:
    return train({posture: [perform(posture, n) for n in range(4)] for posture in KNOWN})


def test_a_posture_of_three_takes_is_known_in_a_fourth_and_the_others_stay(
    known: PostureModel,
) -> None:
    lesson = taught(known, NEW, [perform(NEW, n) for n in range(3)])
    assert lesson.mistaken == ()
    assert {take.rival for take in lesson.takes} <= set(KNOWN)
    assert name(lesson.model, perform(NEW, 9)) == NEW
    for posture in KNOWN:
        assert name(lesson.model, perform(posture, 9)) == posture
    for array in ("start", "transition", "mean", "variance", "fit"):
        assert np.array_equal(getattr(lesson.model, array)[: len(KNOWN)], getattr(known, array))


def test_a_take_of_something_else_is_found(known: PostureModel) -> None:
    takes = [perform(NEW, 0), perform("squat", 5), perform(NEW, 1), perform(NEW, 2)]
    lesson = taught(known, NEW, takes)
    assert lesson.mistaken == (1,)
    assert lesson.takes[1].rival == "squat"


def test_takes_that_have_nothing_in_common_are_refused(known: PostureModel) -> None:
    takes = [perform(posture, 5) for posture in KNOWN]
    with pytest.raises(LearningError, match=r"takes 1, 2, 3 of 3 are not known again .* squat"):
        taught(known, NEW, takes)


def test_two_takes_are_too_few(known: PostureModel) -> None:
    with pytest.raises(LearningError, match="film at least 3"):
        taught(known, NEW, [perform(NEW, n) for n in range(2)])


def test_a_posture_that_was_taught_badly_is_learnt_anew_in_its_place_and_the_others_stay(
    known: PostureModel,
) -> None:
    """Here what is called a squat is a kick at first: nothing of that is left."""
    kicks, squats = ([perform(posture, n) for n in range(3)] for posture in (NEW, "squat"))
    badly = taught(known, "squat", kicks).model
    assert name(badly, perform(NEW, 9)) == "squat"
    lesson = taught(badly, "squat", squats)
    assert lesson.mistaken == ()
    assert lesson.model.names == KNOWN
    assert name(lesson.model, perform("squat", 9)) == "squat"
    fresh = taught(known, "squat", squats).model
    for array in ("start", "transition", "mean", "variance", "fit"):
        assert np.array_equal(getattr(lesson.model, array), getattr(fresh, array))
        assert np.array_equal(getattr(lesson.model, array)[1:], getattr(known, array)[1:])
    for array in ("rest_mean", "rest_variance"):
        assert np.array_equal(getattr(lesson.model, array), getattr(known, array))


def test_a_take_without_motion_is_named(known: PostureModel) -> None:
    takes = [perform(NEW, 0), np.full((30, 20), np.nan), perform(NEW, 1)]
    with pytest.raises(LearningError, match="take 2 has fewer than 5 frames"):
        taught(known, NEW, takes)
