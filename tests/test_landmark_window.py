"""The network sees the right part of the picture, at one size."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from common.bus.messages import Box
from viewer.landmarks.landmark_window import GREY, SIDE, Window, planes_of, whole, window_of


def test_the_window_of_an_outline_is_a_square_about_its_middle_and_a_quarter_larger() -> None:
    window = window_of(Box(left=100, right=139, top=40, bottom=119))
    assert window == Window(70, 30, 100)


def test_the_whole_picture_lies_in_the_middle_of_its_window() -> None:
    assert whole((240, 320, 3)) == Window(0, -40, 320)
    assert whole((320, 240, 3)) == Window(-40, 0, 320)


def test_a_window_of_the_networks_own_size_is_seen_pixel_by_pixel() -> None:
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 256, (240, 300, 3), np.uint8)
    mask = rng.random((240, 300)) < 0.5
    planes = planes_of(picture, mask, Window(20, 30, SIDE))
    there = slice(30, 30 + SIDE), slice(20, 20 + SIDE)
    assert np.array_equal(planes[0, :3].transpose(1, 2, 0), picture[there])
    assert np.array_equal(planes[0, 3], np.where(mask[there], 255, 0))


def test_an_outline_that_is_not_known_is_neither_inside_nor_outside() -> None:
    planes = planes_of(np.zeros((50, 50, 3), np.uint8), None, Window(0, 0, 50))
    assert (planes[0, 3] == GREY).all()


@given(left=st.integers(-400, 400), top=st.integers(-400, 400), side=st.integers(8, 500))
@example(left=0, top=-120, side=8)
def test_beyond_the_picture_all_is_black_and_outside(left: int, top: int, side: int) -> None:
    picture = np.full((120, 160, 3), 200, np.uint8)
    planes = planes_of(picture, np.ones((120, 160), np.bool_), Window(left, top, side))
    for plane, inside in zip(planes[0], (200, 200, 200, 255), strict=True):
        assert plane.max() <= inside
    share = overlap(left, side, 160) * overlap(top, side, 120) / side**2
    assert (planes[0, 0] / 200).mean() == pytest.approx(share, abs=0.04)


def overlap(start: int, side: int, size: int) -> int:
    return max(0, min(start + side, size) - max(start, 0))
