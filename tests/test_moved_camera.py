"""A camera that is turned before a made-up wall, with somebody before it or a thing that comes."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.body.body import Vector
from common.rig.turned_camera import angle_deg
from common.video.decoding import Image
from viewer.background import moved_camera
from viewer.background.background import learn
from viewer.background.moved_camera import AGAIN, LOOK_EVERY, State
from viewer.background.turned_picture import lens_of

SIZE = (160, 120)
LENS = lens_of(None, SIZE)
SOON = 2 * AGAIN * LOOK_EVERY
"""Frames, a second: asked are two."""


def wall(seed: int = 0) -> Image:
    """Larger than a picture: shelves, frames, boards."""
    rng = np.random.default_rng(seed)
    picture = np.full((240, 320, 3), 150, np.uint8)
    for _ in range(70):
        left, top = (int(v) for v in rng.integers((0, 0), (320, 240)))
        wide, high = (int(v) for v in rng.integers(8, 50, 2))
        colour = tuple(int(v) for v in rng.integers(40, 220, 3))
        cv2.rectangle(picture, (left, top), (left + wide, top + high), colour, cv2.FILLED)
    return np.asarray(cv2.GaussianBlur(picture, (3, 3), 0), np.uint8)


def shown(room: Image, turn: Vector = np.eye(3), seed: int = 0, light: float = 1.0) -> Image:
    """What the camera shows of it after a turn, with its noise."""
    high, wide = room.shape[:2]
    middle = np.array([[1, 0, (SIZE[0] - wide) / 2], [0, 1, (SIZE[1] - high) / 2], [0, 0, 1]])
    way = LENS.K @ turn @ np.linalg.inv(LENS.K) @ middle
    picture = cv2.warpPerspective(room, way, SIZE).astype(float) * light
    noise = np.random.default_rng(seed).normal(0, 2, picture.shape)
    return np.asarray(np.clip(picture + noise, 0, 255), np.uint8)


def with_person(picture: Image, at: int) -> Image:
    return np.asarray(
        cv2.rectangle(picture.copy(), (at, 20), (at + 30, 115), (30, 60, 90), cv2.FILLED)
    )


def begun(room: Image) -> State:
    return moved_camera.init(learn([shown(room, seed=n) for n in range(8)]), LENS)


def turn_about(axis: tuple[float, float, float], by_deg: float) -> Vector:
    unit = np.array(axis) / np.linalg.norm(axis)
    return np.asarray(cv2.Rodrigues(unit * np.radians(by_deg))[0])


@settings(max_examples=12, deadline=None)
@given(st.floats(1.0, 8.0), st.integers(0, 3), st.floats(-1.0, 1.0))
def test_a_turn_is_found_within_a_second_and_its_size_with_it(
    by_deg: float, seed: int, up: float
) -> None:
    room = wall(seed)
    turn = turn_about((up, 1.0, 0.3), by_deg)
    state, news = begun(room), []
    for n in range(SOON):
        state, is_new = moved_camera.step(state, with_person(shown(room, turn, n), 40 + 2 * n))
        news.append(is_new)
    assert sum(news) == 1
    assert angle_deg(state.turn @ turn.T) < 0.25
    assert state.shift is not None


@pytest.mark.parametrize("light", [1.0, 0.7, 1.25])
def test_who_walks_through_and_what_the_light_does_are_no_move(light: float) -> None:
    room = wall()
    state = begun(room)
    for n in range(80):
        picture = with_person(shown(room, seed=n, light=1 + (light - 1) * n / 80), 2 * n)
        state, is_new = moved_camera.step(state, picture)
        assert not is_new
    assert state.shift is None


def test_a_door_that_opens_is_no_move() -> None:
    room, other = wall(), wall(7)
    state = begun(room)
    for n in range(40):
        picture = shown(room, seed=n)
        picture[:, :50] = shown(other, seed=n)[:, :50]
        state, is_new = moved_camera.step(state, picture)
        assert not is_new


def test_another_room_and_a_covered_lens_are_no_move() -> None:
    room = wall()
    for other in (wall(7), np.full_like(room, 60)):
        state = begun(room)
        for n in range(40):
            state, is_new = moved_camera.step(state, shown(other, seed=n))
            assert not is_new


def test_a_camera_that_is_put_back_stands_as_it_stood() -> None:
    room, turn = wall(), turn_about((0.2, 1.0, 0.0), 4.0)
    state, news = begun(room), 0
    for n in range(2 * SOON):
        state, is_new = moved_camera.step(state, shown(room, turn if n < SOON else np.eye(3), n))
        news += is_new
    assert news == 2
    assert state.shift is None


def test_before_a_plain_wall_nothing_is_known() -> None:
    plain = np.full((240, 320, 3), 150, np.uint8)
    state = begun(plain)
    for n in range(40):
        state, is_new = moved_camera.step(state, shown(plain, seed=n))
        assert not is_new


def test_a_background_that_is_learnt_after_a_move_knows_of_it() -> None:
    room, turn = wall(), turn_about((0.0, 1.0, 0.0), 4.0)
    state = moved_camera.init(learn([shown(room, turn)]), LENS, turn)
    assert state.shift is not None
    assert state.shift.right_px == pytest.approx(np.tan(np.radians(4.0)) * 200.0)
