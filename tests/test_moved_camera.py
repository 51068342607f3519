"""A camera that is turned before a made-up wall, with somebody before it or a thing that comes."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.body.body import Vector
from common.rig.turned_camera import angle_deg
from common.video.pictures import Image
from viewer.background import moved_camera
from viewer.background.background import learn
from viewer.background.moved_camera import (
    AGAIN,
    LOOK_EVERY,
    PATCH,
    State,
    _alike,
    _found,
    _inside,
    _middle_shift,
    even_of,
)
from viewer.background.turned_picture import lens_of, seen_at

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


def test_marks_lie_apart_and_not_where_the_background_was_guessed() -> None:
    """A twentieth of 120 rows from each other; half a patch beside what was never seen."""
    known = learn([shown(wall(), seed=n) for n in range(8)])
    uncertain = np.zeros((120, 160), np.bool_)
    uncertain[:, 60:100] = True
    marks = moved_camera.init(known._replace(uncertain=uncertain), LENS).marks_px
    assert len(marks) > 16
    apart = np.linalg.norm(marks[:, None] - marks[None], axis=2) + 1e9 * np.eye(len(marks))
    assert apart.min() >= 6.0
    beside = PATCH // 2
    assert not ((marks[:, 0] >= 60 - beside) & (marks[:, 0] < 100 + beside)).any()


def looked(
    monkeypatch: pytest.MonkeyPatch, turns: list[float | None]
) -> tuple[State, list[bool], int]:
    """A camera that is looked at, look by look, and found turned by so many degrees."""
    state = begun(wall())
    coming = list(turns)
    monkeypatch.setattr(moved_camera, "_is_where_it_was", lambda *_: False)

    def found(*_: object) -> Vector | None:
        by_deg = coming.pop(0)
        return None if by_deg is None else turn_about((0.0, 1.0, 0.0), by_deg)

    monkeypatch.setattr(moved_camera, "_found", found)
    told, frames, picture = [], 0, shown(wall())
    while coming:
        before = len(coming)
        state, is_new = moved_camera.step(state, picture)
        frames += 1
        if len(coming) < before:
            told.append(is_new)
        else:
            assert not is_new
    return state, told, frames


def test_a_camera_has_moved_when_two_looks_in_a_row_find_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every fourth frame is looked at; a look that finds nothing, or another turn, begins anew."""
    state, told, frames = looked(monkeypatch, [3.0, None, 3.0, 5.0, 5.0])
    assert told == [False, False, False, False, True]
    assert frames == 5 * LOOK_EVERY
    assert angle_deg(state.turn) == pytest.approx(5.0)
    assert (state.found, state.looks) == (None, 0)


def test_a_turn_by_less_than_a_pixel_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """1.2 px of a focal length of 200 are a third of a degree."""
    state, told, _ = looked(monkeypatch, [0.3, 0.3, 0.3])
    assert told == [False] * 3
    assert (state.found, state.looks) == (None, 0)
    assert state.shift is None
    state, told, _ = looked(monkeypatch, [0.4, 0.4])
    assert told == [False, True]
    assert state.shift is not None


def test_a_turn_is_searched_from_where_the_picture_and_its_middle_lie(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The marks as far aside as the whole is, as far as its middle is, and where they are due."""
    room = cv2.resize(wall(), (320, 240))
    state = begun(room)
    there = np.ascontiguousarray(np.roll(state.even, (5, -7), axis=(0, 1)))
    turn = turn_about((0.0, 1.0, 0.0), 2.0)
    state = state._replace(turn=turn)
    starts: list[np.ndarray] = []
    shares = [0.5, 0.6, 0.55]

    def turn_from(_state: State, _even: np.ndarray, start: np.ndarray) -> tuple[float, Vector]:
        starts.append(start)
        return shares[len(starts) - 1], np.eye(3) * len(starts)

    monkeypatch.setattr(moved_camera, "_turn_from", turn_from)
    best = _found(state, there)
    assert best is not None
    assert np.array_equal(best, 2.0 * np.eye(3))
    aside = np.array([-7.0, 5.0])
    assert starts[0] - state.marks_px == pytest.approx(np.tile(aside, (len(starts[0]), 1)), abs=0.5)
    assert starts[1] - state.marks_px == pytest.approx(np.tile(aside, (len(starts[0]), 1)))
    assert starts[2] == pytest.approx(seen_at(LENS, turn, state.marks_px), abs=1e-3)
    starts.clear()
    shares[:] = [0.49, 0.3, 0.1]
    assert _found(state, there) is None


def test_the_middle_of_a_picture_is_found_where_it_went() -> None:
    even = even_of(shown(wall()))
    assert _middle_shift(even, np.roll(even, (4, 9), axis=(0, 1))) == (9.0, 4.0)


def test_what_is_about_marks_is_alike_by_its_correlation() -> None:
    """Against numpy's; places at the border repeat it."""
    one, other = even_of(shown(wall(1))), even_of(shown(wall(2)))
    at = np.array([[40.0, 30.0], [80.4, 70.6], [2.0, 118.0]])
    there = np.array([[50.0, 20.0], [83.0, 71.0], [157.0, 3.0]])

    def patch(picture: np.ndarray, place: np.ndarray) -> np.ndarray:
        wide = np.pad(picture, 6, mode="edge").astype(float)
        x, y = np.rint(place).astype(int)
        return wide[y : y + PATCH, x : x + PATCH].ravel()

    due = [
        np.corrcoef(patch(one, own), patch(other, far))[0, 1]
        for own, far in zip(at, there, strict=True)
    ]
    marks = at.astype(np.float32)
    assert _alike(one, marks, other, there) == pytest.approx(due, abs=1e-4)
    assert _alike(one, marks, one, at) == pytest.approx([1.0] * 3, abs=1e-5)


def test_a_place_is_inside_of_a_margin_on_all_sides() -> None:
    places = np.array([[4.0, 4.0], [3.9, 9.0], [9.0, 3.9], [26.0, 9.0], [25.9, 15.9], [9.0, 16.0]])
    assert _inside(places, (20, 30), 4).tolist() == [True, False, False, False, True, False]
