"""The shadow at the feet, drawn and cut away."""

import numpy as np

from viewer.silhouette.cast_shadow import without_cast

HEIGHT, WIDTH, FLOOR = 120, 160, 100.0
BODY, SHADOW = np.zeros((HEIGHT, WIDTH), bool), np.zeros((HEIGHT, WIDTH), bool)
BODY[20:100, 70:82] = True
BODY[96:100, 64:88] = True
SHADOW[94:100, 88:130] = True


def picture(shade: float, clothes: float) -> np.ndarray:
    shown = np.full((HEIGHT, WIDTH, 3), FLOOR)
    shown[SHADOW] *= shade
    shown[BODY] = clothes
    return shown.astype(np.uint8)


def found(shade: float, clothes: float) -> np.ndarray:
    room = np.full((HEIGHT, WIDTH, 3), FLOOR, np.float32)
    return without_cast(BODY | SHADOW, picture(shade, clothes), room)


def test_a_hard_shadow_beside_the_feet_is_cut_away() -> None:
    kept = found(0.6, 20.0)
    assert not (kept & SHADOW)[:, 92:].any()
    assert (kept | ~BODY).all()


def test_what_is_darker_or_brighter_than_a_shadow_stays() -> None:
    """A leg that is stretched aside, black or white."""
    for shade in (0.1, 1.5):
        assert (found(shade, 20.0) == (BODY | SHADOW)).all()


def test_a_shadow_that_is_torn_off_goes_as_a_whole() -> None:
    room = np.full((HEIGHT, WIDTH, 3), FLOOR, np.float32)
    mask = BODY.copy()
    mask[90:95, 120:140] = True
    shown = picture(1.0, 20.0)
    shown[90:95, 120:124] = 10
    assert (without_cast(mask, shown, room) == BODY).all()
