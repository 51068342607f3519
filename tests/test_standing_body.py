"""Who stands in the median picture of a clip, held against rendered people whose mask is known."""

import msgspec
import numpy as np
import pytest
from test_judged_background import film
from test_own_landmarks import RIG

from common.body.observation import Landmarks
from synth.motion.motions import MOTION, performance
from synth.person.people import person
from synth.picture.render import render
from viewer.background.image_stack import median
from viewer.room.body_region import body_region
from viewer.room.room_people import Look, looked_at
from viewer.room.standing_body import (
    SHADES,
    UNSEEN,
    _colours,
    _known,
    _smooth,
    _votes,
    standing,
)


@pytest.mark.slow
def test_somebody_who_stays_is_found_whole() -> None:
    """Better than the surest landmarks alone draw them."""
    someone = person(4321)
    motion = performance(someone, "raise_both_lateral", 3)
    shots = list(render(someone, motion, RIG, 77, 3))
    shown = [s for s, phase in zip(shots, motion.phase, strict=True) if phase == MOTION][::4]
    frames, masks = [s.frames[0] for s in shown], np.stack([s.masks[0] for s in shown])
    looks = looked_at(frames)
    found, true = standing(median(frames), looks), masks.mean(axis=0) > 0.5
    surest = max(looks, key=lambda look: sum(look.landmarks.confidence))
    assert iou(found, true) > max(0.75, iou(surest.region(true.shape, 0.0) > 0, true))


def test_nobody_stands_where_nobody_is() -> None:
    empty, frames, _ = film()
    nobody = [Look(look.landmarks, is_somebody=False) for look in looked_at(frames)]
    assert not standing(empty.astype(np.float32), nobody).any()


def test_what_is_larger_than_anybody_is_nobody() -> None:
    """Landmarks of a picture that shows nobody may lie anywhere."""
    empty, frames, _ = film()
    high, wide = empty.shape[:2]
    looks = []
    for look in looked_at(frames):
        places = np.array(look.landmarks.joints_px)
        places = (places - places.mean(axis=0)) * 3.0 + (wide / 2, high / 2)
        joints_px = tuple((float(x), float(y)) for x, y in places)
        landmarks = msgspec.structs.replace(look.landmarks, joints_px=joints_px)
        looks.append(Look(landmarks, is_somebody=True))
    assert not standing(median(frames), looks).any()


def iou(one: np.ndarray, other: np.ndarray) -> float:
    return float((one & other).sum() / (one | other).sum())


def look_at(x: float, sure: float, is_somebody: bool = True) -> Look:
    places = tuple((x + 2.0 * (n % 4), 10.0 + 6.0 * n) for n in range(15))
    return Look(Landmarks(places, (sure,) * 15), is_somebody)


def test_the_surest_looks_vote_most_and_those_of_nobody_for_none() -> None:
    """By their confidence squared: 0.16, 0.36 and 0.64 of 1.16."""
    looks = [look_at(30.0, 0.4), look_at(70.0, 0.6, is_somebody=False), look_at(90.0, 0.8)]
    votes = _votes(looks, (120, 160, 3), 0.03)
    first, _, third = (body_region(look.landmarks, (120, 160), 0.03) for look in looks)
    assert not (first & third).any()
    assert votes == pytest.approx(0.16 / 1.16 * first + 0.64 / 1.16 * third)


def test_how_often_a_colour_is_seen_is_shared_with_its_neighbours() -> None:
    """A half stays, a quarter goes to either side, of each of three axes; by hand."""
    shades = np.array([(3 * SHADES + 4) * SHADES + 5, (7 * SHADES + 0) * SHADES + 2])
    found = _known(shades, np.array([3.0, 1.0])).reshape((SHADES,) * 3)
    kept = 3.0 + 1.0 * 0.75 * 0.75  # at two ends of an axis a quarter is lost
    assert found[3, 4, 5] == pytest.approx(3.0 / 8 / kept)
    assert found[2, 4, 5] == pytest.approx(3.0 / 16 / kept)
    assert found[3, 5, 6] == pytest.approx(3.0 / 32 / kept)
    assert found[7, 0, 2] == pytest.approx(1.0 / 8 / kept)
    assert found.sum() == pytest.approx(1.0)
    few = _known(np.array([0]), np.array([0.25]))
    assert few[0] == pytest.approx(0.25 / 8)


def test_a_colour_speaks_for_the_body_as_often_as_it_is_seen_there() -> None:
    """Only pixels near the body are counted, blue is the first of three eighths of the range."""
    picture = np.zeros((4, 6, 3), np.float32)
    picture[:, :3] = (200.0, 40.0, 100.0)
    picture[:, 3:] = (10.0, 240.0, 250.0)
    body, near = np.full((4, 6), 0.1), np.ones((4, 6), np.bool_)
    body[:, :3], near[2:] = 0.9, False
    picture[2:, :3] = 60.0
    found = _colours(picture, body, near)
    shade = [(6 * 8 + 1) * 8 + 3, (0 * 8 + 7) * 8 + 7]
    own = _known(np.repeat(shade, 6), np.repeat([0.9, 0.1], 6))
    other = _known(np.repeat(shade, 6), np.repeat([0.1, 0.9], 6))
    due = np.log((own + UNSEEN) / (other + UNSEEN))
    assert found[0, 0] == pytest.approx(due[shade[0]])
    assert found[1, 5] == pytest.approx(due[shade[1]])
    assert found[0, 0] > 1.0 > -1.0 > found[1, 5]
    assert found[3, 1] == pytest.approx(0.0)


def test_values_that_are_a_linear_function_of_colours_stay_and_noise_on_them_is_smoothed() -> None:
    rng = np.random.default_rng(4)
    guide = rng.uniform(0.0, 1.0, (30, 40, 3))
    values = guide @ [0.5, -0.3, 0.2] + 0.1
    assert _smooth(guide, values, 3) == pytest.approx(values, abs=0.01)
    noisy = values + rng.normal(0, 0.1, values.shape)
    assert np.std(_smooth(guide, noisy, 3) - values) < 0.05
    flat = np.full((30, 40, 3), 0.5)
    steps = (np.arange(40) >= 20) * np.ones((30, 1))
    found = _smooth(flat, steps, 2)
    assert found[15, 20] == pytest.approx(0.6, abs=0.01)  # the mean of five means of fifths
    assert found[15, [10, 30]] == pytest.approx([0.0, 1.0], abs=0.01)


def drawn_looks() -> tuple[np.ndarray, np.ndarray, list[Look]]:
    """A red body before a grey wall of its brightness, whose landmarks are off to either side; the
    picture, where the body is, and the looks."""
    looks = [look_at(78.0 + off, 0.8) for off in (-3.0, -2.0, -1.0, 1.0, 2.0, 3.0)]
    body = body_region(look_at(78.0, 0.8).landmarks, (120, 160), 0.01) > 0
    noise = np.random.default_rng(5).normal(0.0, 3.0, (120, 160, 3))
    picture = np.where(body[..., None], (60.0, 70.0, 190.0), (110.0, 110.0, 110.0)) + noise
    return picture.astype(np.float32), body, looks


def test_colours_tell_a_body_whose_landmarks_are_off() -> None:
    picture, body, looks = drawn_looks()
    found = standing(picture, looks)
    assert iou(found, body) > 0.97
    voted = np.mean([look.region((120, 160), 0.0) for look in looks], axis=0) > 0.5
    assert iou(voted, body) < 0.95
