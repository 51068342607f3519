"""Whose landmarks a report tells, where a source outside sees several people."""

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.observation import Box, Landmarks
from viewer.landmarks.outside_source import nearest_landmarks


def person(left: int, top: int, right: int, bottom: int, seen: int = 15) -> Landmarks:
    """Of whom so many joints are seen, on the diagonal of a box; the others stand anywhere."""
    steps = np.linspace(0.0, 1.0, seen)
    places = [(left + (right - left) * at, top + (bottom - top) * at) for at in steps]
    rest = len(JOINT_NAMES) - seen
    return Landmarks(
        joints_px=(*places, *[(0.0, 0.0)] * rest), confidence=(*[0.9] * seen, *[0.0] * rest)
    )


NEAR = person(10, 10, 60, 110)
FAR = person(100, 40, 120, 80)
PARTLY_SEEN = person(100, 40, 120, 80, seen=9)


@pytest.mark.parametrize("followed", [FAR, PARTLY_SEEN], ids=["whole", "partly seen"])
def test_of_several_people_it_is_the_one_in_the_outlines_box(followed: Landmarks) -> None:
    box = Box(left=97, right=122, top=36, bottom=84)
    assert nearest_landmarks((NEAR, followed), box) is followed
    box = Box(left=5, right=70, top=5, bottom=115)
    assert nearest_landmarks((NEAR, followed), box) is NEAR


def test_without_an_outline_it_is_the_largest() -> None:
    assert nearest_landmarks((FAR, NEAR), None) is NEAR


def test_where_nobody_is_seen_there_are_no_landmarks() -> None:
    assert nearest_landmarks((), None) is None


def test_the_largest_covers_most_of_the_picture() -> None:
    """35 by 35 is more than 10 by 100."""
    narrow, square = person(0, 0, 10, 100), person(0, 0, 35, 35)
    assert nearest_landmarks((narrow, square), None) is square


@pytest.mark.parametrize("edge", range(4))
def test_an_outlines_box_ends_behind_its_last_pixel(edge: int) -> None:
    """Columns 20 to 59 and rows 30 to 89 reach from 20 to 60 and from 30 to 90."""
    box = Box(left=20, right=59, top=30, bottom=89)
    exact = [20, 30, 60, 90]
    smaller = exact.copy()
    smaller[edge] -= 2
    smaller_one, exact_one = (person(*sides) for sides in (smaller, exact))
    assert nearest_landmarks((smaller_one, exact_one), box) is exact_one
