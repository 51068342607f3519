"""A background that is taken anew: of frames that show nobody, or not at all."""

import numpy as np
from local_bus import LocalBus

from common.bus.control_messages import Command
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
