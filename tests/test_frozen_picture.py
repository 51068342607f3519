"""Pictures that stay the same: a camera's memory, a codec's, a drawn scene's, or a quiet person."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from viewer.frozen_picture import State, _compared, _same, _with_changes, step

Picture = NDArray[np.uint8]
RATE_HZ = 15.0
HIGH, WIDE = 120, 160


WALL = np.broadcast_to(np.linspace(90, 200, WIDE)[None, :, None], (HIGH, WIDE, 3)).astype(np.uint8)


def person(lean_px: int = 0, high: int = HIGH, wide: int = WIDE) -> Picture:
    """A dark person before a wall, drawn without noise; they lean to the right."""
    picture = WALL.copy()
    cv2.line(picture, (80 + lean_px, 20), (80, 110), (40, 60, 80), 14)
    return np.asarray(cv2.resize(picture, (wide, high), interpolation=cv2.INTER_AREA), np.uint8)


def by_sensor(picture: Picture, seed: int) -> Picture:
    noise = np.random.default_rng(seed).normal(0.0, 2.0, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


def by_codec(picture: Picture, seed: int) -> Picture:
    """Blocks of 8 pixels that are off by up to three grey levels, other ones in each frame."""
    high, wide = picture.shape[:2]
    off = np.random.default_rng(seed).integers(-3, 4, (high // 8, wide // 8, 1))
    return (picture + np.kron(off, np.ones((8, 8, 1)))).astype(np.uint8)


def frozen(pictures: list[Picture], moving_since_s: list[float | None]) -> list[bool]:
    state, found = State(), []
    for n, (picture, since_s) in enumerate(zip(pictures, moving_since_s, strict=True)):
        state, is_frozen = step(state, picture, n / RATE_HZ, since_s)
        found.append(is_frozen)
    return found


def moving(count: int, since: int = 0) -> list[float | None]:
    """The other view sees motion of the half second before, from a frame on."""
    return [n / RATE_HZ - 0.5 if n >= since else None for n in range(count)]


@pytest.mark.parametrize("size", [(120, 160), (240, 320), (320, 176)])
def test_a_repeated_picture_that_a_codec_changes_is_frozen_while_the_other_view_sees_motion(
    size: tuple[int, int],
) -> None:
    """Named within a second of the last picture that was one."""
    walking = [by_codec(person(3 * n, *size), n) for n in range(10)]
    held = [by_codec(person(27, *size), n) for n in range(10, 40)]
    found = frozen([*walking, *held], moving(40))
    assert found.index(True) == 9 + 8  # half a second at 15 Hz, and the frame that passes it
    assert all(found[17:])


def test_the_same_is_a_person_who_stands_still_where_the_other_view_sees_no_motion() -> None:
    pictures = [by_codec(person(), n) for n in range(40)]
    assert not any(frozen(pictures, [None] * 40))


def test_motion_before_the_picture_stood_still_proves_nothing() -> None:
    """Who walks, and stops: the last half second of the walk is told for another half second."""
    walking = [person(3 * n) for n in range(10)]
    told = [n / RATE_HZ - 0.5 if n < 17 else None for n in range(30)]
    assert not any(frozen([*walking, *[person(27)] * 20], told))


def test_a_person_who_moves_here_too_is_not_frozen() -> None:
    pictures = [by_codec(person(round(6 * np.sin(n / 3))), n) for n in range(40)]
    assert not any(frozen(pictures, moving(40)))


def test_the_picture_is_back_with_its_first_change() -> None:
    pictures = [person()] * 20 + [person(6)] * 3
    found = frozen(pictures, moving(23))
    assert found[19]
    assert not any(found[20:])


def test_what_is_drawn_without_noise_may_stand_still() -> None:
    """An empty room, then somebody who holds a pose: bit for bit the same, and no fault."""
    pictures = [WALL] * 20 + [person()] * 20 + [person(n) for n in range(5)] + [person(4)] * 20
    assert not any(frozen(pictures, [None] * len(pictures)))


def test_what_a_sensor_took_does_not_come_again_bit_for_bit() -> None:
    pictures = [by_sensor(person(), n) for n in range(3)]
    assert frozen([*pictures, *[pictures[-1]] * 5], [None] * 8) == [False] * 5 + [True] * 3


def test_pictures_are_the_same_bit_for_bit_and_cells_tell_where_they_are_not() -> None:
    """Cells of 16 pixels, the last one in part; what was reached before stays so."""
    one = np.random.default_rng(2).integers(0, 255, (40, 50, 3), dtype=np.uint8)
    assert _same(one, one.copy())
    for y, x, c in ((0, 0, 0), (39, 49, 2), (17, 30, 1)):
        other = one.copy()
        other[y, x, c] += 1
        assert not _same(one, other)
        before = np.zeros((3, 4), np.bool_)
        before[1, 0] = True
        reached = _with_changes(one, other, before)
        due = before.copy()
        due[y // 16, x // 16] = True
        assert np.array_equal(reached, due)
        assert before.sum() == 1


def test_blocks_of_a_fortieth_of_the_longer_side_are_held_against_the_first() -> None:
    """Eight grey levels of one block are a codec's, nine are a change; slow drifts add up."""
    first = np.full((60, 80, 3), 100, np.uint8)
    state = _compared(State(), first, 1.0)
    assert state.blocks is not None
    assert state.blocks.shape == (30, 40, 3)
    shown = first.copy()
    shown[10:12, 40:42] = 108
    contradicted = state._replace(contradicted=True)
    assert _compared(contradicted, shown, 2.0) is contradicted
    shown[10:12, 40:42] = 109
    found = _compared(contradicted, shown, 3.0)
    assert (found.still_since_s, found.contradicted) == (3.0, False)
    assert found.blocks is not None
    assert found.blocks[5, 20, 0] == 109.0
    repeated = state._replace(repeats=1)
    assert _compared(repeated, shown, 4.0) is repeated
    upright = _compared(State(), np.ascontiguousarray(first.transpose(1, 0, 2)), 1.0)
    assert upright.blocks is not None
    assert upright.blocks.shape == (40, 30, 3)


@pytest.mark.parametrize(("rate_hz", "first"), [(15.0, 3), (30.0, 5), (10.0, 3)])
def test_a_noisy_picture_is_frozen_after_two_repeats_and_their_time(
    rate_hz: float, first: int
) -> None:
    """Two fifteenths of a second: more than two repeats, and longer than that."""
    state = State()
    for n in range(4):
        state, _ = step(state, by_sensor(WALL, n), n / rate_hz, None)
    still = by_sensor(WALL, 3)
    found = []
    for n in range(4, 12):
        state, is_frozen = step(state, still, n / rate_hz, None)
        found.append(is_frozen)
    assert found.index(True) + 1 == first
    assert all(found[first - 1 :])


def test_a_picture_of_another_shape_begins_anew() -> None:
    state = State()
    for n in range(9):
        state, is_frozen = step(state, by_sensor(WALL, min(n, 2)), n / RATE_HZ, None)
    assert is_frozen
    assert state.repeats == 6
    turned = np.ascontiguousarray(by_sensor(WALL, 2).transpose(1, 0, 2))
    state, is_frozen = step(state, turned, 1.0, None)
    assert not is_frozen
    assert (state.repeats, state.since_s) == (0, 1.0)
    assert state.reached is not None
    assert state.reached.shape == (10, 8)
