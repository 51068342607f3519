"""The child that looks by MediaPipe, in this process: what it reads, and what it answers."""

import io
from types import SimpleNamespace

import numpy as np
import pytest

from common.platform.platform import Asker
from viewer.landmarks import mediapipe_child
from viewer.landmarks.mediapipe_protocol import (
    BYTES,
    NOBODY,
    POINTS,
    READY,
    REFUSED,
    Answer,
    answer_of,
)

WIDTH, HEIGHT = 8, 6


class Pose:
    """A stand-in: a person whose first point lies as far across as the first pixel is red."""

    def __init__(self) -> None:
        self.shown: list[np.ndarray] = []

    def process(self, picture: np.ndarray) -> SimpleNamespace:
        self.shown.append(picture.copy())
        if picture[0, 0, 0] == 0:
            return SimpleNamespace(pose_landmarks=None)
        points = [
            SimpleNamespace(x=picture[0, 0, 0] / 100 + i / 100, y=0.5 + i / 50, visibility=i / 64)
            for i in range(33)
        ]
        return SimpleNamespace(pose_landmarks=SimpleNamespace(landmark=points))


def test_points_are_told_in_pixels_of_a_picture_whose_colours_are_turned_about() -> None:
    """MediaPipe takes red first, and answers in shares of the width and of the height."""
    picture = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    picture[0, 0] = 9, 5, 25
    pose = Pose()
    points = mediapipe_child.looked(pose, picture)
    assert pose.shown[0][0, 0].tolist() == [25, 5, 9]
    assert points is not None
    assert points.dtype == np.float32
    assert points[3] == pytest.approx([0.28 * WIDTH, 0.56 * HEIGHT, 3 / 64])
    assert mediapipe_child.looked(pose, np.zeros((HEIGHT, WIDTH, 3), np.uint8)) is None


def test_an_answer_is_sent_at_once() -> None:
    flushed = []
    answers = io.BytesIO()
    answers.flush = lambda: flushed.append(answers.getvalue())  # type: ignore[method-assign]
    mediapipe_child.say(answers, b"abc")
    assert flushed == [b"abc"]


def answered(lines: list[bytes], red: int) -> list[Answer]:
    """What the child's main function answers to some lines about a picture."""
    picture = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    picture[0, 0] = 1, 2, red
    answers = io.BytesIO()
    mediapipe_child.main(Asker(lines, answers, picture))
    said = answers.getvalue()
    return [answer_of(said[at : at + BYTES]) for at in range(0, len(said), BYTES)]


def test_each_line_is_answered_with_its_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mediapipe_child, "opened", Pose)
    answers = answered([b"4\n", b"17\n"], red=25)
    assert [(one.kind, one.frame) for one in answers] == [(READY, -1), (POINTS, 4), (POINTS, 17)]
    assert answers[1].points[0] == pytest.approx([0.25 * WIDTH, 0.5 * HEIGHT, 0.0])
    assert answers[1].points[32] == pytest.approx([0.57 * WIDTH, 1.14 * HEIGHT, 0.5])


def test_a_picture_of_nobody_is_answered_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mediapipe_child, "opened", Pose)
    answers = answered([b"6"], red=0)
    assert [(one.kind, one.frame) for one in answers] == [(READY, -1), (NOBODY, 6)]


def test_what_keeps_it_from_its_work_is_said_and_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def opened() -> None:
        raise ImportError("no module named attrs")

    monkeypatch.setattr(mediapipe_child, "opened", opened)
    answers = answered([b"4"], red=25)
    assert [one.kind for one in answers] == [REFUSED]
    assert answers[0].text == "ImportError: no module named attrs"
