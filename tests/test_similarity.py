"""The score, held against equation (1) and the numbers that follow from it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from common.raster.similarity import Mask, similarity

masks = arrays.arrays(np.bool_, st.just((5, 7)))


def bar(first: int, width: int) -> Mask:
    """A bar ten rows high in a picture of 100 columns."""
    mask = np.zeros((10, 100), np.bool_)
    mask[:, first : first + width] = True
    return mask


@given(masks.filter(np.any))
def test_what_coincides_scores_one(mask: Mask) -> None:
    """P9."""
    assert similarity(mask, mask) == 1.0


@given(masks)
def test_a_model_that_covers_nothing_scores_zero(seen: Mask) -> None:
    """P9: two empty masks included."""
    assert similarity(seen, np.zeros_like(seen)) == 0.0


@given(masks.filter(np.any))
def test_an_empty_silhouette_scores_the_same_whatever_is_drawn(drawn: Mask) -> None:
    """M25: e^-1, more than a model that covers half of a person; so S cannot tell presence."""
    lost = similarity(np.zeros_like(drawn), drawn)
    assert lost == pytest.approx(math.exp(-1), abs=1e-12)
    assert lost > similarity(bar(0, 40), bar(0, 20))


@given(masks, masks)
def test_score_is_the_overlap_times_what_the_model_leaves_out(seen: Mask, drawn: Mask) -> None:
    """P9: p + n = 1 - IoU, so S = exp(IoU - 1) (1 - p)."""
    union = (seen | drawn).sum()
    if union == 0:
        return
    overlap = (seen & drawn).sum() / union
    left_out = (seen & ~drawn).sum() / union
    assert similarity(seen, drawn) == pytest.approx(math.exp(overlap - 1) * (1 - left_out))


@pytest.mark.parametrize(
    ("drawn", "score"),
    [(bar(0, 20), 0.303), (bar(0, 80), 0.607), (bar(10, 40), 0.536)],
    ids=["half cover", "double cover", "shifted by 10 of 40"],
)
def test_shares_are_of_the_union_and_missing_costs_more_than_adding(
    drawn: Mask, score: float
) -> None:
    """P9: with the sum of both areas for the union, the shifted bar would score 0.68."""
    assert similarity(bar(0, 40), drawn) == pytest.approx(score, abs=5e-4)


@given(masks, masks)
def test_score_is_a_plain_number_from_zero_to_one(seen: Mask, drawn: Mask) -> None:
    score = similarity(seen, drawn)
    assert type(score) is float
    assert 0.0 <= score <= 1.0
