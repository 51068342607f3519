"""Packed masks, held against the masks that were packed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.raster.bits import blank, count, count_both, pack_words, unpack_words, words_of_rows
from common.raster.silhouette_report import pack


@settings(deadline=None)
@given(st.tuples(st.integers(1, 130), st.integers(1, 70)), st.integers(0, 2**32 - 1))
def test_packing_gives_back_the_mask(size: tuple[int, int], seed: int) -> None:
    mask = np.random.default_rng(seed).random(size[::-1]) < 0.5
    assert (unpack_words(pack_words(mask), size[0]) == mask).all()
    assert (words_of_rows(pack(mask), *size) == pack_words(mask)).all()


def test_the_first_pixel_of_a_row_is_the_lowest_bit_of_its_first_word() -> None:
    """By hand: 70 columns are two words, of the second of which six bits are used."""
    mask = np.zeros((3, 70), np.bool_)
    mask[0, [0, 2, 63]] = mask[1, 64] = mask[2, [9, 69]] = True
    words = [[(1 << 63) + 5, 0], [0, 1], [1 << 9, 1 << 5]]
    assert pack_words(mask).tolist() == words
    assert words_of_rows(pack(mask), 70, 3).tolist() == words
    other = mask.copy()
    other[0, 2] = other[2, 69] = False
    assert (count(pack_words(mask)), count_both(pack_words(mask), pack_words(other))) == (6, 4)


@pytest.mark.parametrize(("width", "words"), [(1, 1), (64, 1), (65, 2), (128, 2), (129, 3)])
def test_rows_have_as_many_words_as_they_need(width: int, words: int) -> None:
    full = np.ones((5, width), np.bool_)
    assert blank((width, 5)).shape == pack_words(full).shape == (5, words)
    assert not blank((width, 5)).any()
    assert count(pack_words(full)) == 5 * width
