"""A posture that few takes teach: known again, told apart, and nothing else changed."""

from typing import Any

import numpy as np
import pytest
from acting import perform

from lab.posture_models import lesson as lessons
from lab.posture_models.learning import train
from lab.posture_models.lesson import Lesson, taught
from recognizer.codebook import LearningError
from recognizer.postures import PostureModel, name

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
    with pytest.raises(LearningError, match="record at least 3"):
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


def judged(monkeypatch: pytest.MonkeyPatch, known: PostureModel, *margins: float) -> Lesson:
    """Takes of 10 frames, of which the last two have no pose, by so many nats a frame likelier or
    less likely than the walk; the squat is less likely still. Each is judged by all the others."""
    learnt: list[list[float]] = []

    def extending(
        model: object, given: dict[str, list[np.ndarray]], performers: object = ()
    ) -> Any:
        learnt.append([float(rows[0, 0]) for rows in given["bow"]])
        return ("model", performers)

    def scoring(model: object, seen: np.ndarray) -> dict[str, float]:
        assert len(seen) == 8
        own = 8 * margins[int(seen[0, 0])]
        return {"squat": -60.0, "bow": own - 40.0, "walk_toward": -40.0}

    monkeypatch.setattr(lessons, "extended", extending)
    monkeypatch.setattr(lessons, "scored", scoring)
    takes = [np.full((10, 20), float(n)) for n in range(len(margins))]
    for rows in takes:
        rows[8:] = np.nan
    lesson = taught(known, "bow", takes, ["ann"])
    numbers = [float(n) for n in range(len(margins))]
    assert learnt == [*([n for n in numbers if n != k] for k in numbers), numbers]
    return lesson


def test_a_margin_is_of_a_frame_over_the_likeliest_other(
    monkeypatch: pytest.MonkeyPatch, known: PostureModel
) -> None:
    lesson = judged(monkeypatch, known, 0.5, 1.25, -0.25, 0.01)
    assert [take.margin for take in lesson.takes] == pytest.approx([0.5, 1.25, -0.25, 0.01])
    assert {take.rival for take in lesson.takes} == {"walk_toward"}
    assert lesson.mistaken == (2,)
    assert lesson.model == ("model", ["ann"])  # type: ignore[comparison-overlap]


@pytest.mark.parametrize(
    ("margins", "refused"),
    [
        ((1.0, 0.0, 1.0), ""),
        ((1.0, 0.0, -1.0), "2, 3 of 3"),
        ((1.0, 0.0, -1.0, 0.1), ""),
        ((-0.5, 0.0, -1.0, 0.1), "1, 2, 3 of 4"),
    ],
)
def test_takes_are_refused_of_which_more_than_half_are_mistaken(
    monkeypatch: pytest.MonkeyPatch,
    known: PostureModel,
    margins: tuple[float, ...],
    refused: str,
) -> None:
    if not refused:
        judged(monkeypatch, known, *margins)
        return
    with pytest.raises(LearningError, match=f"takes {refused} are not .* likelier walk_toward; "):
        judged(monkeypatch, known, *margins)


def test_a_take_must_have_as_many_frames_as_a_model_has_states(known: PostureModel) -> None:
    whole = perform(NEW, 0)
    for frames, well in ((4, False), (5, True)):
        takes = [whole, perform(NEW, 1), np.concatenate([whole[:frames], np.full((9, 20), np.nan)])]
        if well:
            assert len(taught(known, NEW, takes).takes) == 3
        else:
            with pytest.raises(LearningError, match="take 3 has fewer than 5 frames of motion"):
                taught(known, NEW, takes)
