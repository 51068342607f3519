"""The empty room, held against rooms and people that are drawn here."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from common.video.pictures import Image
from viewer.background.background import (
    _range,
    estimated,
    even_light,
    large_regions,
    learn,
    light_gain,
    lit,
    overlaid_opening,
    slopes,
    spread_of,
)
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


def plain_gain(frame: Image, background: NDArray[np.float32]) -> NDArray[np.float64]:
    """The median of the ratios on the grid by numpy, then four means of what lies around it."""
    stride = max(1, int(np.sqrt(background[..., 0].size / 1500.0)))
    at = slice(stride // 2, None, stride)
    gains = np.ones(3)
    for c in range(3):
        given, due = frame[at, at, c].ravel().astype(float), background[at, at, c].ravel()
        bins = (given / np.maximum(due, 1.0) * 300).astype(int)
        used = (due > 20) & ((given < 250) | (due >= 250)) & (bins < 600)
        seen = np.bincount(bins[used], given[used], 600)
        asked = np.bincount(bins[used], due[used], 600)
        if not asked.sum():
            continue
        middle = int(np.flatnonzero(np.cumsum(asked) >= asked.sum() / 2)[0])
        for _ in range(4):
            around = slice(max(0, middle - 18), middle + 19)
            gains[c] = seen[around].sum() / asked[around].sum()
            middle = min(int(gains[c] * 300), 599)
    return gains


@pytest.mark.parametrize("size", [(30, 40), (120, 160), (100, 310)])
def test_a_gain_is_the_median_of_ratios_and_the_mean_around_it(size: tuple[int, int]) -> None:
    """Against plain numpy, where each channel has its own light and its own half in shadow."""
    rng = np.random.default_rng(7)
    background = rng.uniform(25, 240, (*size, 3)).astype(np.float32)
    share = rng.choice([1.0, 0.93, 1.08, 0.4], (*size, 1), p=[0.5, 0.2, 0.1, 0.2])
    frame = np.clip(
        background * share * (1.2, 0.9, 0.75) + rng.normal(0, 3, background.shape), 0, 255
    )
    shown = frame.astype(np.uint8)
    assert light_gain(shown, background) == pytest.approx(plain_gain(shown, background), rel=1e-3)


@pytest.mark.parametrize(
    ("level", "shown", "gain"),
    [
        (20.0, 40, 1.0),
        (21.0, 42, 1.0),
        (21.0, 41, 41 / 21),
        (100.0, 249, 1.0),
        (200.0, 249, 1.245),
        (200.0, 250, 1.0),
        (250.0, 255, 1.02),
        (200.0, 0, 0.01),
    ],
)
def test_what_is_too_dark_white_or_twice_as_bright_tells_no_gain(
    level: float, shown: int, gain: float
) -> None:
    """Both sides of each bound; a black frame has a hundredth of the light."""
    background = np.full((30, 40, 3), level, np.float32)
    frame = np.full((30, 40, 3), shown, np.uint8)
    assert light_gain(frame, background) == pytest.approx([gain] * 3)


def test_pictures_under_even_light_have_each_channels_gain_taken_out() -> None:
    base = room()
    frames = [shot(base * np.array(f), 0.0, 0) for f in ((1, 1, 1), (1.1, 0.9, 1), (0.9, 1, 1.2))]
    even = even_light(frames)
    assert even.shape == (3, HEIGHT, WIDTH, 3)
    for own in even:
        assert np.abs(own - base).mean(axis=(0, 1)) == pytest.approx([0.0] * 3, abs=0.8)


def test_pictures_with_less_than_a_fifth_of_the_light_are_left_out() -> None:
    """Every eighth row and column tells: what lies between does not."""
    frames = [np.full((20, 30, 3), level, np.uint8) for level in (19, 100, 20, 0)]
    frames[0][1:8] = 255
    assert [int(frame[0, 0, 0]) for frame in lit(frames)] == [100, 20]
    assert lit([]) == []


def test_a_backgrounds_range_is_what_was_seen_and_two_levels_of_noise() -> None:
    """W4 by hand: 10, 40, 35 has steps of 30 and 5; what holds still has the noise for a step."""
    frames = [np.full((2, 3, 3), level, np.uint8) for level in (10, 40, 35)]
    for frame in frames:
        frame[0, 0] = 7
    low, high, step = _range(frames)
    assert (low[1, 2, 0], high[1, 2, 0], step[1, 2, 0]) == (10.0, 40.0, 30.0)
    assert (low[0, 0, 0], high[0, 0, 0], step[0, 0, 0]) == (7.0, 7.0, 2.0)
    learnt = learn(frames)
    assert np.array_equal(learnt.step, step)
    assert np.array_equal(learnt.high, high)
    assert np.array_equal(learnt.low, low)


def test_an_estimated_background_is_its_own_range() -> None:
    centre = np.full((2, 3, 3), 50.0, np.float32)
    spread, uncertain = np.full((2, 3, 2), 4.0, np.float32), np.eye(2, 3) > 0
    found = estimated(centre, spread, uncertain)
    assert [found.low[0, 0, 0], found.high[0, 0, 0], found.step[0, 0, 0]] == [50.0, 50.0, 2.0]
    assert found.spread is spread
    assert found.uncertain is uncertain


def test_a_spread_is_pooled_over_five_pixels_and_never_less_than_rounding() -> None:
    """By hand: 50 over five degrees of freedom at one pixel of 25, brightness; colour likewise."""
    squares = np.zeros((11, 13, 2), np.float32)
    squares[5, 6] = 50.0, 200.0
    found = spread_of(squares, 6)
    assert found[5, 6] == pytest.approx([np.sqrt(0.4 + 1.0), np.sqrt(1.6 + 6.25)])
    assert found[7, 8] == pytest.approx(found[5, 6])
    assert found[8, 6] == pytest.approx([1.0, 2.5])
    assert spread_of(squares, 1)[0, 0] == pytest.approx([np.hypot(2, 1), np.hypot(2, 2.5)])


def test_a_region_is_as_tall_as_a_tenth_of_the_picture() -> None:
    """Gaps of four pixels are closed, and a hole of one stays a hole."""
    mask = np.zeros((100, 120), np.bool_)
    mask[10:20, 10:30] = True
    mask[40:49, 10:100] = True
    mask[60:90, 50:80] = True
    mask[70:80, 60:70] = False
    mask[20:24, 100:102] = True
    found = large_regions(mask)
    wanted = mask.copy()
    wanted[40:49] = wanted[20:24, 100:] = False
    assert np.array_equal(found > 0, wanted)


def test_a_slope_is_sobels_eight_times_the_change_a_pixel() -> None:
    rows, columns = np.indices((9, 11))
    assert slopes((3.0 * columns + 4.0 * rows).astype(np.float32))[4, 5] == pytest.approx(40.0)


def test_the_opening_is_laid_over_itself_under_the_light_of_its_median() -> None:
    """Of three pictures the brightest third is not the scene's light."""
    frames = [shot(room() * gain, 0.0, 0) for gain in (1.0, 1.02, 1.3)]
    found = overlaid_opening(frames)
    assert np.abs(found.mean - room() * 1.02).mean() < 0.6
    assert not found.moving.any()
