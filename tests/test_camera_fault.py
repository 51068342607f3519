"""Pictures that show no room: frozen, black, white, covered; and rooms that only look so."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from viewer.background.background import learn
from viewer.camera_fault import State, _blank, _contrast, _contrast_of, _grey, init, step
from viewer.frozen_picture import FROZEN_AFTER

Picture = NDArray[np.uint8]
RANDOM = np.random.default_rng(5)


def noisy(plain: Picture) -> Picture:
    """As a sensor gives it: two grey levels of noise."""
    return np.clip(plain + RANDOM.normal(0.0, 2.0, plain.shape), 0, 255).astype(np.uint8)


def room(low: int, high: int) -> Picture:
    """Walls between two grey levels."""
    column = np.linspace(low, high, 160)
    return np.broadcast_to(column[None, :, None], (120, 160, 3)).astype(np.uint8)


def somebody(picture: Picture) -> Picture:
    shown = picture.copy()
    cv2.rectangle(shown, (60, 20), (90, 110), (40, 60, 80), cv2.FILLED)
    return shown


def faults(state: State, pictures: list[Picture], rate_hz: float = 15.0) -> list[str]:
    found: list[str] = []
    for n, picture in enumerate(pictures):
        state, fault = step(state, picture, n / rate_hz)
        found.append(fault)
    return found


def knows(plain: Picture) -> State:
    return init(learn([noisy(plain) for _ in range(8)]))


def test_a_picture_that_is_repeated_bit_for_bit_is_frozen_until_it_changes() -> None:
    view = room(40, 200)
    still = noisy(view)
    found = faults(knows(view), [noisy(view), *[still] * 6, noisy(view), still])
    assert found == [""] * (2 + FROZEN_AFTER) + ["frozen"] * 3 + ["", ""]


@pytest.mark.parametrize(("camera_hz", "file_hz"), [(15, 60), (7.5, 30), (10, 50), (24, 120)])
def test_a_slow_cameras_pictures_in_a_fast_file_are_not_frozen(
    camera_hz: float, file_hz: float
) -> None:
    view, often = room(40, 200), int(file_hz / camera_hz)
    held = [picture for _ in range(6) for picture in [noisy(view)] * often]
    assert faults(knows(view), held, file_hz) == [""] * len(held)


def test_a_person_who_stands_still_is_no_frozen_picture() -> None:
    view = room(40, 200)
    assert faults(knows(view), [noisy(somebody(view)) for _ in range(40)]) == [""] * 40


@pytest.mark.parametrize(("level", "fault"), [(3, "black"), (252, "saturated"), (120, "covered")])
def test_a_lens_that_shows_nothing_is_told_for_what_it_is(level: int, fault: str) -> None:
    shown = noisy(np.full((120, 160, 3), level, np.uint8))
    assert faults(knows(room(40, 200)), [shown]) == [fault]


@pytest.mark.parametrize("level", [8, 128, 250], ids=["night", "plain wall", "white studio"])
def test_a_room_that_is_plain_itself_is_no_fault(level: int) -> None:
    plain = np.full((120, 160, 3), level, np.uint8)
    assert faults(knows(plain), [noisy(plain), noisy(somebody(plain))]) == ["", ""]


def test_who_stands_before_a_wall_that_goes_dark_is_not_looked_for() -> None:
    wall = np.full((120, 160, 3), 128, np.uint8)
    dark = np.full((120, 160, 3), 3, np.uint8)
    assert faults(knows(wall), [noisy(wall), noisy(dark)]) == ["", "black"]


@pytest.mark.parametrize("gain", [0.5, 0.8, 1.3], ids=["dusk", "cloud", "sun"])
@pytest.mark.parametrize("view", [room(40, 200), room(150, 160)], ids=["a room", "a plain wall"])
def test_other_light_is_no_fault(view: Picture, gain: float) -> None:
    lit = np.clip(gain * view, 0, 255).astype(np.uint8)
    assert faults(knows(view), [noisy(lit), noisy(somebody(lit))]) == ["", ""]


def sums_of(picture: Picture) -> NDArray[np.int64]:
    """Of every fourth pixel of every fourth row, the least first."""
    return np.sort(picture[::4, ::4].sum(axis=2).astype(np.int64), axis=None)


@pytest.mark.parametrize("size", [(13, 30), (40, 22), (120, 160)])
def test_contrast_is_what_lies_between_the_darkest_and_the_brightest_tenth(
    size: tuple[int, int],
) -> None:
    """Against numpy's sorting; of a picture by counting, of the background by its grey levels."""
    picture = np.random.default_rng(size[0]).integers(0, 256, (*size, 3), dtype=np.uint8)
    picture[: size[0] // 2, :, 1] //= 3
    ranked = sums_of(picture)
    tenth = len(ranked) // 10
    due = (ranked[-1 - tenth] - ranked[tenth]) / 3
    assert _contrast_of(picture) == pytest.approx(due)
    grey = _grey(picture)
    assert grey == pytest.approx(picture[::4, ::4].mean(axis=2), rel=1e-6)
    assert _contrast(grey) == pytest.approx(due, rel=1e-5)


def halves(low: int, high: int) -> Picture:
    """Two even halves, of so many grey levels."""
    picture = np.full((40, 60, 3), low, np.uint8)
    picture[:, 30:] = high
    return picture


@pytest.mark.parametrize(
    ("background", "picture", "fault"),
    [
        ((60, 150), (100, 117), ""),
        ((60, 150), (100, 116), "covered"),
        ((100, 131), (100, 116), ""),
        ((100, 132), (100, 116), "covered"),
        ((60, 150), (59, 59), "black"),
        ((60, 150), (60, 60), "covered"),
        ((60, 150), (195, 195), "covered"),
        ((60, 150), (196, 196), "saturated"),
        ((100, 100), (20, 20), ""),
        ((100, 100), (19, 19), "black"),
    ],
)
def test_a_plain_picture_is_named_by_its_level_unless_the_wall_is_plain(
    background: tuple[int, int], picture: tuple[int, int], fault: str
) -> None:
    """Both sides of each bound: 16 and 32 grey levels of contrast, 60 and 195, a fifth of the
    light."""
    assert _blank(_grey(halves(*background)), halves(*picture)) == fault
