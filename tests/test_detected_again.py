"""Known people who are looked at again where they are detected."""

import numpy as np
import pytest
from test_landmark_step import detected, standing

from viewer.landmarks.landmark_window import Window
from viewer.landmarks.person_mask import LandmarkResult, PersonMask
from viewer.people.detected_again import is_sure_at, owners_of
from viewer.people.known_people import People, Track


def test_a_detection_shows_the_known_person_whom_it_overlaps_most_and_far_ones_none() -> None:
    """Of two who stand close each has their own, in whatever order they are detected."""
    people = People((Track(4, standing(100.0), 0.0), Track(9, standing(116.0), 0.0)), 4, 10)
    owners = owners_of(
        [detected(118.0), detected(98.0), detected(280.0)], people, LandmarkResult(None)
    )
    assert owners == [9, 4, None]
    assert owners_of([], people, LandmarkResult(None)) == []


@pytest.mark.parametrize(
    ("sure", "is_carried", "off_px", "enough"),
    [(0.6, False, 0, True), (0.4, False, 0, False), (0.4, True, 0, True), (0.6, True, 90, False)],
)
def test_who_is_carried_on_is_not_looked_at_where_they_are_detected_at_that_place(
    sure: float, is_carried: bool, off_px: int, enough: bool
) -> None:
    """Who is carried on was surely seen, and is less sure by now."""
    window = Window(50, 40, 150)
    mask = PersonMask(np.zeros((48, 48), np.float32), window)
    look = LandmarkResult(standing(125.0, sure), mask, carried=is_carried)
    assert is_sure_at(look, window._replace(left=window.left + off_px)) == enough
