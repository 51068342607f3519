"""What a mask alone tells, held against its pixels."""

import cv2
import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.body.observation import Box
from common.raster.silhouette_report import (
    box_of,
    centroid_px,
    is_cut,
    mask_of,
    people_of,
    silhouette_view,
    unpack,
    with_silhouette,
)


def masks() -> tuple[np.ndarray, np.ndarray]:
    whole = np.zeros((6, 9), np.bool_)
    whole[2:5, 3:7] = True
    part = whole.copy()
    part[:, 5:] = False
    part[0, 3] = True
    return whole, part


def test_a_report_tells_what_its_mask_does() -> None:
    whole, _ = masks()
    view = silhouette_view(2, whole, 7, 0.5)
    assert (view.viewer, view.frame, view.captured_s) == (2, 7, 0.5)
    assert (view.width, view.height) == (9, 6)
    (person,) = view.people
    assert view.person is person
    assert (person.width, person.height) == (9, 6)
    assert person.box == Box(left=3, right=6, top=2, bottom=4)
    assert (person.area_px, person.cut) == (12, False)
    assert np.array_equal(unpack(person), whole)
    assert np.array_equal(mask_of(view), whole)


def test_another_silhouette_changes_what_it_tells_and_nothing_else() -> None:
    whole, part = masks()
    (person,) = people_of(whole)
    person = msgspec.structs.replace(person, refusal="why")
    found = with_silhouette(person, part)
    assert (found.area_px, found.cut, found.refusal) == (7, True, "why")
    assert np.array_equal(unpack(found), part)
    assert with_silhouette(found, whole) == person


def test_an_empty_mask_is_no_person() -> None:
    view = silhouette_view(1, np.zeros((4, 5), np.bool_))
    assert (view.people, view.person, view.width, view.height) == ((), None, 5, 4)
    assert np.array_equal(mask_of(view), np.zeros((4, 5), np.bool_))


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
