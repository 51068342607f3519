"""The standing height, held against people who squat, raise their arms and come nearer (T20)."""

import numpy as np
import pytest

from viewer.stick.standing_height import standing_rows, statures_px


def drawn(tall: int, arms_up: bool = False) -> np.ndarray:
    """A trunk of some height on row 110, with arms beside the head or not."""
    mask = np.zeros((120, 160), np.bool_)
    mask[110 - tall : 110, 74:86] = True
    if arms_up:
        mask[max(0, 90 - tall) : 110 - tall // 2, 66:70] = True
        mask[max(0, 90 - tall) : 110 - tall // 2, 90:94] = True
    return mask


def test_raised_arms_are_no_height() -> None:
    assert standing_rows(drawn(80, arms_up=True)) == standing_rows(drawn(80)) == (30.0, 110.0)


def test_a_squat_does_not_shrink_the_scale() -> None:
    """T20: the height of standing frames holds for the squats between them."""
    rows = np.array([standing_rows(drawn(tall)) for tall in (80, 80, 79, 60, 50, 60, 80, 81)])
    found = statures_px(rows[:, 0], rows[:, 1], np.ones(8, np.bool_))
    assert found == pytest.approx(np.full(8, 80.0), abs=1.0)


def test_who_comes_nearer_grows_with_their_feet() -> None:
    soles = np.linspace(60.0, 110.0, 30)
    true = 0.6 * (soles - 10.0)
    crowns = soles - true
    crowns[::6] += 15.0  # bows
    assert statures_px(crowns, soles, np.ones(30, np.bool_)) == pytest.approx(true, rel=0.03)


def test_who_is_partly_outside_tells_no_height() -> None:
    crowns, soles = np.array([30.0, 0.0, 30.0]), np.array([110.0, 60.0, 110.0])
    found = statures_px(crowns, soles, np.array([True, False, True]))
    assert found == pytest.approx(np.full(3, 80.0))


def test_nobody_has_no_height() -> None:
    nothing = np.full(4, np.nan)
    assert np.isnan(statures_px(nothing, nothing, np.zeros(4, np.bool_))).all()


@pytest.mark.filterwarnings("error")
def test_a_few_frames_of_which_one_is_odd_still_have_a_height() -> None:
    crowns, soles = np.array([20.0, 20, 20, 50, 20, 20]), np.array([110.0, 110, 110, 51, 110, 110])
    found = statures_px(crowns, soles, np.ones(6, np.bool_))
    assert np.isfinite(found).all()
    assert found.min() > 0.0
