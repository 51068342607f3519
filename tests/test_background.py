"""The empty room, held against rooms and people that are drawn here."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from common.video.decoding import Image
from viewer.background.background import even_light, learn, light_gain
from viewer.background.occluded_background import learn_uncovered

HEIGHT, WIDTH = 120, 160


def room() -> NDArray[np.float64]:
    """A wall with soft stains over a floor."""
    noise = np.random.default_rng(1).normal(size=(HEIGHT, WIDTH, 3))
    stains = cv2.GaussianBlur(noise, (0, 0), 6)
    walls = 130 + 10 * stains / stains.std()
    walls[85:] -= (10, 30, 45)
    return np.asarray(np.clip(walls, 40, 200), np.float64)


def shot(picture: NDArray[np.float64], sigma: float, seed: int) -> Image:
    noise = np.random.default_rng(seed).normal(0, sigma, picture.shape)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)


def walker(frame: int) -> NDArray[np.float64]:
    """Somebody in black who walks on the spot: the trunk stays, arms and legs swing."""
    picture = room()
    swing = int(12 * np.sin(frame / 2))
    cv2.rectangle(picture, (72, 30), (88, 70), (25, 20, 20), -1)
    for side in (-1, 1):
        cv2.line(picture, (80, 68), (80 + side * swing, 105), (25, 20, 20), 7)
        cv2.line(picture, (80, 36), (80 + side * (6 + swing), 66), (60, 80, 110), 5)
    return picture


def passer_by(frame: int) -> NDArray[np.float64]:
    picture = room()
    cv2.rectangle(picture, (-20 + 6 * frame, 30), (6 * frame, 105), (25, 20, 20), -1)
    return picture


def test_noise_of_the_sensor_is_learnt() -> None:
    learnt = learn([shot(room(), 4.0, seed) for seed in range(8)])
    # brightness mixes three channels: 4 * sqrt(0.114^2 + 0.587^2 + 0.299^2) = 2.67, and rounding
    expected = np.hypot(4 * np.linalg.norm([0.114, 0.587, 0.299]), 1.0)
    assert np.median(learnt.spread[..., 0]) == pytest.approx(expected, rel=0.1)
    assert np.abs(learnt.centre - room()).mean() < 4 / np.sqrt(8)
    assert not learnt.uncertain.any()


def test_flicker_while_learning_is_not_noise() -> None:
    steady = learn([shot(room(), 1.0, seed) for seed in range(8)])
    flickering = learn([shot(room() * (0.9 + 0.025 * n), 1.0, n) for n in range(8)])
    assert np.median(flickering.spread) == pytest.approx(np.median(steady.spread), rel=0.1)


def test_one_picture_is_enough_of_a_room() -> None:
    learnt = learn([shot(room(), 0.0, 0)])
    assert np.array_equal(learnt.centre, shot(room(), 0.0, 0))
    assert learnt.spread.min() >= 2


@pytest.mark.parametrize("learner", [learn, learn_uncovered])
def test_no_frame_is_no_room(learner: object) -> None:
    with pytest.raises(ValueError, match="at least 1 frame, got 0"):
        learner([])  # type: ignore[operator]


@pytest.mark.parametrize("factors", [(0.85, 0.85, 0.85), (1.15, 1.15, 1.15), (1.1, 1.0, 0.9)])
def test_gain_is_that_of_the_light_whoever_stands_there(
    factors: tuple[float, float, float],
) -> None:
    picture = walker(0)
    picture[:, :40] *= 0.8
    frame = shot(picture * factors, 2.0, 0)
    assert light_gain(frame, room().astype(np.float32)) == pytest.approx(factors, abs=0.006)


def test_white_room_keeps_its_gain() -> None:
    """A studio that the camera shows as pure white (frontside_walk)."""
    white = np.full((HEIGHT, WIDTH, 3), 255.0)
    frame = shot(white, 0.0, 0)
    frame[30:100, 60:100] = 30
    assert light_gain(frame, white.astype(np.float32)) == pytest.approx([1, 1, 1])


@pytest.mark.parametrize("dark", [1, 3])
def test_a_black_frame_among_the_first_is_no_fault_and_no_room(dark: int) -> None:
    """As when a camera starts, or somebody passes a light switch."""
    film = [shot(room(), 2.0, seed) for seed in range(8)]
    film[:dark] = [np.zeros_like(film[0])] * dark
    assert np.abs(learn(film).centre - room()).mean() < 2.0
    assert np.isfinite(even_light(film)).all()
