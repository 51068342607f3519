"""A background that is taken anew: of frames that show nobody, or not at all."""

import numpy as np
import pytest
from local_bus import LocalBus

from common.bus.control_messages import Answer, Command
from viewer.background.new_background import Learning

DUE = 8
RNG = np.random.default_rng(5)


def room(level: int) -> np.ndarray:
    """An even wall with the noise of a camera."""
    return np.clip(RNG.normal(level, 1.5, (60, 80, 3)), 0, 255).astype(np.uint8)


def test_nothing_is_learnt_before_it_is_asked_for() -> None:
    learning = Learning(LocalBus().subscribe(Command), 1, DUE)
    assert [learning.step(room(90), "") for _ in range(2 * DUE)] == [(None, None)] * 2 * DUE


def test_frames_after_the_word_become_the_background_once() -> None:
    bus = LocalBus()
    learning = Learning(bus.subscribe(Command), 2, DUE)
    learning.step(room(40), "")
    bus.publish(Command(what="background"))
    told = [learning.step(room(140), "") for _ in range(2 * DUE)]
    learnt = [(background, answer) for background, answer in told if background is not None]
    assert len(learnt) == 1
    background, answer = learnt[0]
    assert answer is not None
    assert answer.well
    assert "camera 2" in answer.text
    assert abs(float(background.centre.mean()) - 140) < 1.0


def test_where_somebody_moves_the_old_one_stays() -> None:
    bus = LocalBus()
    learning = Learning(bus.subscribe(Command), 1, DUE)
    bus.publish(Command(what="background"))
    answers = []
    for n in range(DUE):
        picture = room(140)
        picture[10:50, 6 * n : 6 * n + 20] = 20
        background, answer = learning.step(picture, "")
        assert background is None
        answers.append(answer)
    assert answers[-1] is not None
    assert not answers[-1].well


def test_a_camera_that_is_covered_learns_no_cover() -> None:
    bus = LocalBus()
    learning = Learning(bus.subscribe(Command), 1, DUE)
    bus.publish(Command(what="background"))
    background, answer = learning.step(room(2), "black")
    assert background is None
    assert answer is not None
    assert not answer.well
    assert "black" in answer.text
    assert [learning.step(room(2), "") for _ in range(DUE)] == [(None, None)] * DUE


def test_each_answer_says_which_camera_and_why() -> None:
    bus = LocalBus()
    learning = Learning(bus.subscribe(Command), 2, 3)
    bus.publish(Command(what="background"))
    answered = [learning.step(room(90), fault)[1] for fault in ("", "frozen", "")]
    frozen = "camera 2: its picture is frozen: the background stays as it was"
    assert answered == [None, Answer(what="background", well=False, text=frozen), None]
    bus.publish(Command(what="background"))
    answered = [learning.step(room(level), "")[1] for level in (90, 90, 90)]
    new = Answer(what="background", well=True, text="camera 2: it has a new background")
    assert answered == [None, None, new]
    assert learning.step(room(90), "") == (None, None)


def test_a_word_that_comes_again_begins_anew_and_others_are_not_for_it() -> None:
    """Two frames of before are not counted; pictures are copied, for a camera's may be reused."""
    bus = LocalBus()
    learning = Learning(bus.subscribe(Command), 1, 3)
    bus.publish(Command(what="front"))
    shared = room(60)
    assert [learning.step(shared, "")[0] for _ in range(3)] == [None] * 3
    bus.publish(Command(what="background"))
    assert [learning.step(shared, "")[0] for _ in range(2)] == [None] * 2
    bus.publish(Command(what="background"))
    levels, learnt = (140, 150, 145), []
    for level in levels:
        shared[:] = level
        learnt.append(learning.step(shared, "")[0])
    assert learnt[:2] == [None, None]
    assert learnt[2] is not None
    assert [float(learnt[2].low.max()), float(learnt[2].high.min())] == [140.0, 150.0]


def test_black_frames_among_those_that_are_learnt_from_are_left_out() -> None:
    bus = LocalBus()
    learning = Learning(bus.subscribe(Command), 1, 3)
    bus.publish(Command(what="background"))
    told = [learning.step(room(level), "") for level in (140, 0, 140)]
    background, answer = told[-1]
    assert answer is not None
    assert answer.well
    assert background is not None
    assert background.centre.mean() == pytest.approx(140.0, abs=1.0)
