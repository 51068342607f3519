"""The room behind somebody who never leaves, held against rooms that are drawn here."""

import cv2
import numpy as np
import pytest
from test_background import HEIGHT, WIDTH, shot

from common.config.part_settings import SilhouetteSettings
from common.method import DEFAULT
from viewer.background.hidden_background import learn_behind
from viewer.silhouette import silhouette

WALL = (120, 110, 100)


def frames_of(clothes: tuple[int, int, int]) -> list[np.ndarray]:
    """Somebody stands before a wall and swings an arm to a side for every fourth frame."""
    frames = []
    for n in range(24):
        picture = np.full((HEIGHT, WIDTH, 3), WALL, np.float64)
        cv2.rectangle(picture, (20, 0), (60, HEIGHT), (60, 140, 60), -1)
        cv2.rectangle(picture, (70, 30), (90, 110), clothes, -1)
        if n % 4 == 0:
            cv2.rectangle(picture, (91, 40), (120, 48), (40, 60, 160), -1)
        frames.append(shot(picture, 1.0, n))
    return frames


def standing() -> np.ndarray:
    body = np.zeros((HEIGHT, WIDTH), np.bool_)
    body[30:111, 70:91] = True
    return body


def everywhere(frames: list[np.ndarray]) -> list[np.ndarray]:
    """Landmarks that rule nothing out."""
    return [np.ones((HEIGHT, WIDTH), np.uint8) for _ in frames]


def test_whoever_wears_the_walls_colour_is_seen_where_the_wall_was_not() -> None:
    frames = frames_of(WALL)
    state = silhouette.init(
        learn_behind(frames, standing(), everywhere(frames)), SilhouetteSettings(), DEFAULT
    )
    _, seen = silhouette.step(state, frames[1], None)
    assert (seen.mask & standing()).sum() > 0.95 * standing().sum()
    assert (seen.mask & ~standing()).sum() < 0.1 * standing().sum()


def test_what_an_arm_uncovers_is_the_room_and_what_nothing_does_is_flagged() -> None:
    frames = frames_of((30, 30, 90))
    room = learn_behind(frames, standing(), everywhere(frames))
    beside = ~(cv2.dilate(standing().view(np.uint8), np.ones((5, 5))) > 0)
    assert room.uncertain[standing()].all()
    assert not room.uncertain[beside].any()
    assert np.abs(room.centre[42:47, 95:118] - WALL).max() < 4


def test_where_somebody_stands_in_most_frames_the_others_show_the_room() -> None:
    """Who steps aside in a quarter of a clip: no place is left unknown."""
    frames = frames_of((30, 30, 90))
    empty = np.full((HEIGHT, WIDTH, 3), WALL, np.float64)
    cv2.rectangle(empty, (20, 0), (60, HEIGHT), (60, 140, 60), -1)
    frames += [shot(empty, 1.0, n) for n in range(8)]
    room = learn_behind(frames, standing(), everywhere(frames))
    assert room.uncertain.mean() < 0.001
    assert np.abs(room.centre[standing()] - WALL).max() < 5


def test_a_room_that_no_side_tells_is_seen_where_landmarks_have_nobody() -> None:
    """A picture hangs behind somebody who steps aside: it goes on behind them, not the wall."""
    frames = frames_of((30, 30, 90))
    picture = np.full((HEIGHT, WIDTH, 3), WALL, np.float64)
    cv2.rectangle(picture, (72, 40), (88, 80), (200, 220, 230), -1)
    frames += [shot(picture, 1.0, n) for n in range(8)]
    hung = np.zeros((HEIGHT, WIDTH), np.bool_)
    hung[40:81, 72:89] = True
    away = everywhere(frames)[:24] + 8 * [np.zeros((HEIGHT, WIDTH), np.uint8)]
    assert learn_behind(frames, standing(), everywhere(frames)).uncertain[hung].mean() > 0.9
    room = learn_behind(frames, standing(), away)
    assert not room.uncertain[hung].any()
    assert np.abs(room.centre[hung] - (200, 220, 230)).max() < 5


def hidden_by(clothes: int, shown: int) -> tuple[np.ndarray, np.ndarray]:
    """What is made of a body of one grey before a grey wall that so many of 30 frames show: the
    background in its middle, and whether that is unknown."""
    frames = [np.full((40, 60, 3), 100, np.uint8) for _ in range(30)]
    body = np.zeros((40, 60), np.bool_)
    body[10:30, 20:26] = True
    for frame in frames[shown:]:
        frame[body] = clothes
    learnt = learn_behind(frames, body, [np.ones((40, 60), np.uint8)] * 30)
    assert learnt.centre[5, 5] == pytest.approx([100.0] * 3, abs=0.5)
    assert not learnt.uncertain[5, 5]
    return learnt.centre[20, 23], learnt.uncertain[20, 23]


@pytest.mark.parametrize(
    ("clothes", "shown", "level", "unknown"),
    [
        (200, 0, 0.0, True),
        (60, 0, 255.0, True),
        (200, 2, 0.0, True),
        (200, 3, 100.0, False),
        (60, 4, 100.0, False),
    ],
)
def test_what_a_tenth_of_the_frames_show_is_the_wall_else_it_is_farthest_from_the_body(
    clothes: int, shown: int, level: float, unknown: bool
) -> None:
    """Black behind the bright, white behind the dark: three of thirty frames are enough."""
    centre, uncertain = hidden_by(clothes, shown)
    assert centre == pytest.approx([level] * 3, abs=0.5)
    assert uncertain == unknown
