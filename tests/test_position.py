"""Shifts of the model, held against the paper's candidates and silhouettes shifted by numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from posing import ROOT_PX, SIZE, laid_over, picture, posed, stretched, view

from common.body.kinematics import ALL_LIMBS
from common.raster.bits import pack_words
from viewer.paper.position import (
    MOST_PASSES,
    SHIFTS_PX,
    UPRIGHT,
    best_shift,
    extent,
    located,
    shifted_counts,
)

shifts = st.integers(-10, 10)


def place(right: int, down: int) -> tuple[float, float]:
    return ROOT_PX[0] + right, ROOT_PX[1] + down


def test_the_candidates_are_the_papers_and_the_incumbent() -> None:
    """P27: -5, -2, -1, +1, +2, +5 pixels, and staying."""
    assert sorted(SHIFTS_PX) == [-5, -2, -1, 0, 1, 2, 5]
    assert SHIFTS_PX[0] == 0


@pytest.mark.parametrize("axis", [0, 1], ids=["X or Z, columns", "Y, rows"])
@pytest.mark.parametrize("shift", range(-10, 11))
def test_every_whole_shift_up_to_ten_pixels_is_found_exactly(shift: int, axis: int) -> None:
    """P27, P28, with the repeats; the body stays wholly in the picture."""
    start = (ROOT_PX[0], ROOT_PX[1] - 8.0)
    root = (start[0] + shift, start[1]) if axis == 0 else (start[0], start[1] + shift)
    model = laid_over(picture(stretched(), root_px=root), stretched())
    found = located(model._replace(view=view(1, start)))
    assert tuple(found.view[14:16]) == root


@settings(deadline=None)
@given(shifts, st.integers(-8, 0))
def test_a_shift_along_both_axes_is_found_to_a_pixel(right: int, down: int) -> None:
    """P27-P29: the two axes are searched one after the other, X first."""
    seen = picture(stretched(), root_px=place(right, down))
    found = located(laid_over(seen, stretched()))
    assert found.view[14:16] == pytest.approx(place(right, down), abs=1.0)


def test_one_pass_would_leave_a_pixel() -> None:
    """P27: shifts of 3, 4 and 6 to 10 need a second or a third pass; so up to three are made."""
    left_over = {}
    drawn = pack_words(picture(stretched()))
    for shift in range(-10, 11):
        seen = picture(stretched(), root_px=place(shift, 0))
        for passes in (1, MOST_PASSES):
            right, _, _, _ = best_shift(
                drawn, pack_words(seen), int(seen.sum()), SIZE[0], np.array(SHIFTS_PX), passes
            )
            left_over[shift, passes] = abs(shift - right)
    assert {abs(s) for s, n in left_over if n == 1 and left_over[s, 1]} == {3, 4, 6, 7, 8, 9, 10}
    assert [left_over[s, 1] for s in (3, 4, 6)] == [1, 1, 1]
    assert not any(left_over[s, 3] for s in range(-10, 11))


def test_a_body_that_stays_costs_a_match_and_six_more_an_axis() -> None:
    """P27: one pass an axis; the incumbent is matched once."""
    assert located(laid_over(picture(posed()), posed())).matches == 1 + 6 + 6
    seen = picture(posed(), root_px=place(5, 0))
    assert located(laid_over(seen, posed())).matches == 1 + 6 + 6 + 6


@pytest.mark.parametrize(("limbs", "off_px"), [(ALL_LIMBS, 3.0), (UPRIGHT, 0.0)])
def test_old_arms_pull_the_printed_model_after_them(limbs: int, off_px: float) -> None:
    """P27: the whole model is shifted, whose arms are those of the frame before, 12 degrees higher
    than they are now; without them the body stays where it is."""
    seen = picture(posed(r_shoulder_z=102.0, l_shoulder_z=258.0))
    found = located(laid_over(seen, stretched()), limbs)
    assert tuple(found.view[14:16] - view(1)[14:16]) == (0.0, off_px)


def test_a_tie_stays() -> None:
    """P27: an empty picture moves nobody."""
    found = located(laid_over(np.zeros(SIZE[::-1], np.bool_), posed()))
    assert tuple(found.view[14:16]) == ROOT_PX


@settings(deadline=None)
@given(st.integers(1, 200), st.integers(-63, 63), st.integers(-30, 30), st.integers(0, 2**32 - 1))
def test_shifted_pixels_are_counted_as_numpy_counts_them(
    width: int, right: int, down: int, seed: int
) -> None:
    """P27: what leaves the picture does not count."""
    model, seen = np.random.default_rng(seed).random((2, 20, width)) < 0.5
    moved = np.zeros_like(model)
    for y, x in np.argwhere(model):
        if 0 <= y + down < 20 and 0 <= x + right < width:
            moved[y + down, x + right] = True
    bits = pack_words(model)
    counts = shifted_counts(bits, extent(bits), pack_words(seen), width, right, down)
    assert counts == (moved.sum(), (moved & seen).sum())


def test_the_shift_is_whole_pixels_of_the_view() -> None:
    found = located(laid_over(picture(posed(), root_px=place(4, -3)), posed()))
    assert tuple(found.view[14:16] - view(1)[14:16]) == (4.0, -3.0)
