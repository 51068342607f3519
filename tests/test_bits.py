"""Packed masks, held against the masks that were packed."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from common.raster.bits import pack_words, unpack_words, words_of_rows
from common.raster.silhouette_report import pack


@settings(deadline=None)
@given(st.tuples(st.integers(1, 130), st.integers(1, 70)), st.integers(0, 2**32 - 1))
def test_packing_gives_back_the_mask(size: tuple[int, int], seed: int) -> None:
    mask = np.random.default_rng(seed).random(size[::-1]) < 0.5
    assert (unpack_words(pack_words(mask), size[0]) == mask).all()
    assert (words_of_rows(pack(mask), *size) == pack_words(mask)).all()
