"""Sizes of pictures as they are written, and what is worked on of a source."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.config.picture_size import size_of, size_within, working_size

sizes = st.tuples(st.integers(32, 4096), st.integers(32, 4096))


@given(sizes)
def test_a_size_is_read_as_it_is_written(size: tuple[int, int]) -> None:
    assert size_of(f"{size[0]}x{size[1]}") == size


@pytest.mark.parametrize(
    "text", ["", "x", "160", "160x", "160x120x3", "-160x120", "1e3x100", "²x9"]
)
def test_what_is_no_size_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="size must look like 160x120"):
        size_of(text)


@given(sizes, sizes)
def test_a_working_size_keeps_the_shape_within_the_bound(
    source: tuple[int, int], bound: tuple[int, int]
) -> None:
    """P1: aspect kept to a pixel's rounding, as large as fits, never larger than the source."""
    if (source[0] < source[1]) != (bound[0] < bound[1]):
        bound = bound[::-1]
    width, height = working_size(source, bound)
    assert 1 <= width <= min(source[0], bound[0])
    assert 1 <= height <= min(source[1], bound[1])
    assert (width, height) == source or width == bound[0] or height == bound[1]
    shrink = min(1.0, bound[0] / source[0], bound[1] / source[1])
    assert (width, height) == pytest.approx((source[0] * shrink, source[1] * shrink), abs=1.0)


def test_the_bound_is_reached() -> None:
    assert working_size((640, 480), (160, 120)) == (160, 120)
    assert working_size((1920, 1080), (160, 120)) == (160, 90)
    assert working_size((100, 80), (160, 120)) == (100, 80)


@pytest.mark.parametrize("bound", [(320, 240), (240, 320)])
def test_an_upright_video_has_as_many_pixels_as_a_wide_one(bound: tuple[int, int]) -> None:
    """However the bound is written; a square picture has no side that is longer."""
    assert working_size((1080, 1920), bound) == (180, 320)
    assert working_size((1920, 1080), bound) == (320, 180)
    assert working_size((480, 640), bound) == (240, 320)
    assert working_size((500, 500), bound) == (240, 240)


def test_what_is_shown_stays_within_its_bound_however_it_is_turned() -> None:
    assert size_within((1080, 1920), (320, 240)) == (135, 240)
