"""Who is followed where others and things differ from the room too (T8)."""

import numpy as np

from common.config import SilhouetteSettings
from viewer.background.background import learn
from viewer.background.image_stack import Frame
from viewer.silhouette import silhouette, target_selection
from viewer.silhouette.target_selection import AT_REST_S, without_others

HEIGHT, WIDTH = 120, 160
WALL, BLACK = (120, 130, 140), (25, 20, 20)


def block(*places: tuple[slice, slice]) -> np.ndarray:
    mask = np.zeros((HEIGHT, WIDTH), np.bool_)
    for place in places:
        mask[place] = True
    return mask


BODY = np.s_[20:100, 60:80]
OTHER = np.s_[10:50, 100:112]
SPOT = np.s_[110:114, 60:64]


def test_somebody_else_who_comes_is_left_out() -> None:
    assert np.array_equal(without_others(block(BODY, OTHER), block(BODY)), block(BODY))


def test_parts_that_a_belt_of_the_walls_colour_divides_stay() -> None:
    parts = np.s_[20:55, 60:80], np.s_[60:100, 60:80]
    moved = [np.roll(block(part), 2, axis=1) for part in parts]
    assert np.array_equal(without_others(moved[0] | moved[1], block(*parts)), moved[0] | moved[1])


def test_a_part_that_was_missed_for_a_frame_comes_back() -> None:
    """Clothes of the wall's colour hide a trunk, legs alone are left for a moment."""
    trunk, legs = np.s_[20:55, 60:80], np.s_[60:100, 60:80]
    assert np.array_equal(without_others(block(trunk, legs), block(legs)), block(trunk, legs))
    assert np.array_equal(without_others(block(OTHER, legs), block(legs)), block(legs))


def test_a_reflection_on_the_floor_is_left_out() -> None:
    nobody = np.zeros((HEIGHT, WIDTH), np.bool_)
    assert np.array_equal(without_others(block(BODY, SPOT), nobody), block(BODY))


def scene(*things: tuple[tuple[slice, slice], tuple[int, int, int]]) -> Frame:
    picture = np.full((HEIGHT, WIDTH, 3), WALL, np.uint8)
    for place, colour in things:
        picture[place] = colour
    return picture


def test_a_sheet_that_was_moved_is_no_body_once_it_is_at_rest() -> None:
    """It has a colour that the room had all along, and does not move."""
    bed, edge = np.s_[50:118, 20:70], np.s_[60:90, 80:84]
    white = (250, 250, 250)
    seen = silhouette.init(learn([scene((bed, white))]), SilhouetteSettings())
    state = target_selection.init((HEIGHT, WIDTH), things_move=True)
    dt_s = 0.1
    for n in range(20 + int(AT_REST_S / dt_s)):
        things = [(bed, white), (BODY, BLACK)] + ([(edge, white)] if n > 15 else [])
        picture = scene(*things)
        seen, found = silhouette.step(seen, picture, None)
        state, body, seen = target_selection.step(state, picture, found.mask, seen, dt_s)
        if n == 17:
            assert body[edge].mean() > 0.5
    assert body[edge].mean() < 0.1
    assert body[BODY].mean() > 0.95
