"""The network sees the right part of the picture, at one size."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from common.body.observation import Box
from viewer.landmarks.landmark_window import (
    GREY,
    SIDE,
    Window,
    planes_of,
    turned_window_of,
    whole,
    window_about,
    window_of,
)


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


@pytest.mark.parametrize("turn_deg", [0.0, 37.0, 90.0, -120.0, 180.0])
def test_a_spot_is_in_the_picture_where_its_window_has_it(turn_deg: float) -> None:
    picture = np.zeros((240, 320, 3), np.uint8)
    picture[99:104, 199:204] = 255
    window = Window(110, 30, 150, turn_deg)
    rows, columns = np.nonzero(planes_of(picture, None, window)[0, 0] > 127)
    middle = np.array([[columns.mean() + 0.5, rows.mean() + 0.5]])
    assert window.in_picture(middle)[0] == pytest.approx([201.5, 101.5], abs=0.6)


def test_what_points_to_the_right_points_up_in_a_window_that_is_turned_so() -> None:
    picture = np.zeros((240, 320, 3), np.uint8)
    picture[118:122, 160:220] = 255  # from the middle to the right
    plane = planes_of(picture, None, Window(80, 40, 160, 90.0))[0, 0]
    rows, columns = np.nonzero(plane > 127)
    assert rows.mean() < 0.35 * SIDE
    assert columns.mean() == pytest.approx(SIDE / 2, abs=2.0)


@given(
    turn_deg=st.floats(-180, 180),
    places=st.lists(
        st.tuples(st.floats(0, 320), st.floats(0, 240)), min_size=2, max_size=15, unique=True
    ),
)
def test_a_window_holds_all_that_it_is_about(
    turn_deg: float, places: list[tuple[float, float]]
) -> None:
    window = window_about(np.array(places), turn_deg)
    corners = window.in_picture(np.array([(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]))
    for corner, after in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side, beside = after - corner, np.array(places) - corner
        assert (side[0] * beside[:, 1] - side[1] * beside[:, 0] > -1e-6).all()


def test_the_window_of_who_lies_is_as_large_as_that_of_who_stands() -> None:
    mask = np.zeros((240, 320), np.bool_)
    mask[100:120, 60:160] = True
    lying, standing = turned_window_of(mask, 90.0), turned_window_of(mask.T, 0.0)
    assert lying.side == standing.side
    slanting = turned_window_of(mask, 45.0)
    assert slanting.side < lying.side


def overlap(start: int, side: int, size: int) -> int:
    return max(0, min(start + side, size) - max(start, 0))


def test_a_margin_is_added_on_both_sides() -> None:
    """40 by 80 about (60, 70), a tenth of 80 more on either side, and a quarter of that."""
    corners = np.array([[40.0, 30.0], [80.0, 110.0]])
    assert window_about(corners, margin=0.1) == Window(0, 10, 120)


@pytest.mark.parametrize("turn_deg", [30.0, 45.0, 190.0])
def test_a_turned_window_sees_the_picture_up_to_its_corners(turn_deg: float) -> None:
    picture = np.full((240, 320, 3), 200, np.uint8)
    planes = planes_of(picture, np.ones((240, 320), np.bool_), Window(110, 70, 100, turn_deg))
    assert (planes[0, :3] == 200).all()
    assert (planes[0, 3] == 255).all()
