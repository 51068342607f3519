"""Regions of the coarse picture, held against OpenCV's and against people drawn by hand (P4)."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from viewer.silhouette.regions import chosen

LEAST_SHARE = 0.3


def cells(*boxes: tuple[int, int, int, int]) -> NDArray[np.uint8]:
    """60 rows of 80 cells, ones in boxes (left, top, width, height)."""
    found = np.zeros((60, 80), np.uint8)
    for left, top, width, height in boxes:
        found[top : top + height, left : left + width] = 1
    return found


def around(*boxes: tuple[int, int, int, int]) -> NDArray[np.uint8]:
    return np.asarray(cv2.dilate(cells(*boxes), np.ones((3, 3), np.uint8)), np.uint8)


LARGE, SMALL, SPECK = (10, 10, 12, 40), (50, 15, 8, 30), (40, 5, 2, 2)


def test_the_largest_region_is_taken_and_what_is_too_low_is_nobody() -> None:
    own, people = chosen(cells(LARGE, SMALL, SPECK), LEAST_SHARE)
    assert np.array_equal(own, around(LARGE))
    assert people == 2
    assert chosen(cells(SPECK), LEAST_SHARE)[1] == 0


def test_the_region_where_somebody_is_expected_goes_before_a_larger_one() -> None:
    own, people = chosen(cells(LARGE, SMALL), LEAST_SHARE, (52.0, 33.0))
    assert np.array_equal(own, around(SMALL))
    assert people == 2


def test_a_body_that_its_belt_parts_is_one_and_who_stands_beside_is_not() -> None:
    """Over the best region and near to it: the same body."""
    chest, legs, beside = (20, 5, 10, 12), (20, 22, 10, 30), (33, 10, 10, 25)
    own, people = chosen(cells(chest, legs, beside), LEAST_SHARE)
    assert np.array_equal(own, around(chest, legs))
    assert people == 2


@pytest.mark.parametrize("share", [0.02, 0.05, 0.2])
def test_the_region_is_one_of_opencvs(share: float) -> None:
    found = (np.random.default_rng(3).random((60, 80)) < share).astype(np.uint8)
    joined = cv2.dilate(found, np.ones((3, 3), np.uint8))
    _, labels, stats, _ = cv2.connectedComponentsWithStats(joined, connectivity=8)
    best = 1 + stats[1:, cv2.CC_STAT_AREA].argmax()
    own, _ = chosen(found, 0.0)
    assert own[labels == best].all()
    for other in set(range(1, len(stats))) - {best}:
        assert len(np.unique(own[labels == other])) == 1
