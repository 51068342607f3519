"""Where a silhouette stands in its picture, held against its pixels."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.bus.messages import Box
from common.raster.bounds import box_of, centroid_px, is_cut


def test_a_box_is_the_boundary_of_what_was_drawn() -> None:
    """P11: extremes, first and last column and row."""
    mask = np.zeros((50, 60), np.bool_)
    mask[7, 30] = mask[40, 12] = mask[20, 55] = True
    assert box_of(mask) == Box(left=12, right=55, top=7, bottom=40)


def test_nothing_has_no_boundary_and_goes_nowhere() -> None:
    mask = np.zeros((5, 6), np.bool_)
    assert box_of(mask) is None
    assert not is_cut(None, mask.shape)


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(1, 9), st.floats(0.0, 0.3))
def test_what_is_cut_has_a_pixel_on_the_border(
    seed: int, high: int, wide: int, full: float
) -> None:
    mask = np.random.default_rng(seed).random((high, wide)) < full
    border = mask[[0, -1]].any() or mask[:, [0, -1]].any()
    assert is_cut(box_of(mask), mask.shape) == border


@pytest.mark.parametrize("inside", [0, 1])
def test_a_mask_of_bytes_is_bounded_as_one_of_truths(inside: int) -> None:
    mask = np.zeros((8, 9), np.uint8)
    mask[2:5, 3:7] = inside
    assert box_of(mask) == box_of(mask > 0)


def test_the_centroid_is_opencvs() -> None:
    mask = np.random.default_rng(5).random((24, 32)) < 0.2
    moments = cv2.moments(mask.view(np.uint8), binaryImage=True)
    middle = (moments["m10"] / moments["m00"] + 0.5, moments["m01"] / moments["m00"] + 0.5)
    assert centroid_px(mask) == middle
