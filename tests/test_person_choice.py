"""Which of each view's people are one person: two who are seen exactly, in any order."""

import msgspec
import numpy as np
import pytest
from staging import RIG
from two_people import first_m, other_m, seen

from common.body.observation import Box, Observation
from integrator.rig.person_choice import chosen, costs_of

FIRST_M = np.array([0.0, 0.9, 0.0])
OTHER_M = other_m(0)[0]
ONE, TWO = ([seen(view, joints_m(0)) for view in (0, 1)] for joints_m in (first_m, other_m))


def choice(
    people: list[tuple[Observation, ...]], expected_m: np.ndarray | None = None
) -> tuple[int, ...]:
    costs = [costs_of(RIG.cameras[n], each, expected_m) for n, each in enumerate(people)]
    return chosen(RIG, people, costs)


def test_one_person_in_each_view_leaves_no_choice() -> None:
    assert choice([(ONE[0],), (TWO[1],)]) == (0, 0)
    assert choice([(), (TWO[1],)]) == (-1, 0)
    assert choice([(), ()]) == (-1, -1)


def test_people_whose_sight_lines_meet_are_one_person_whatever_their_order() -> None:
    assert choice([(ONE[0], TWO[0]), (TWO[1],)]) == (1, 0)
    assert choice([(TWO[0],), (ONE[1], TWO[1])]) == (0, 1)


def sized(person: Observation, high_px: int, left_px: int) -> Observation:
    box = Box(left_px, left_px + 9, 10, 9 + high_px)
    return msgspec.structs.replace(person, box=box)


MIDDLE_PX, SIDE_PX = 75, 10
"""Columns of a picture 160 wide."""


@pytest.mark.parametrize(
    ("first", "second", "found"),
    [
        ((40, MIDDLE_PX), (40, MIDDLE_PX), 0),
        ((36, MIDDLE_PX), (40, MIDDLE_PX), 0),
        ((30, MIDDLE_PX), (40, MIDDLE_PX), 1),
        ((50, SIDE_PX), (40, MIDDLE_PX), 1),
        ((80, SIDE_PX), (40, MIDDLE_PX), 0),
    ],
)
def test_where_no_person_is_expected_it_is_the_larger_above_all_in_the_middle_of_the_pictures(
    first: tuple[int, int], second: tuple[int, int], found: int
) -> None:
    """In both views; of two about as large it is whom the viewers follow."""
    people: list[tuple[Observation, ...]] = [
        (sized(TWO[n], *first), sized(ONE[n], *second)) for n in (0, 1)
    ]
    assert choice(people) == (found, found)


@pytest.mark.parametrize(("expected_m", "found"), [(FIRST_M, (1, 1)), (OTHER_M, (0, 0))])
def test_the_expected_person_comes_before_whom_the_viewers_follow(
    expected_m: np.ndarray, found: tuple[int, int]
) -> None:
    assert choice([(TWO[0], ONE[0]), (TWO[1], ONE[1])], expected_m) == found


def test_another_person_in_both_views_is_not_taken_for_the_expected_one() -> None:
    """View 2 has lost the first person: view 1 alone goes on with them."""
    assert choice([(ONE[0], TWO[0]), (TWO[1],)], FIRST_M)[0] == 0


def test_a_third_view_shows_the_same_person_as_the_two_that_meet() -> None:
    rig = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    people = [(ONE[0], TWO[0]), (TWO[1],), (ONE[0], TWO[0])]
    costs = [costs_of(camera, each, None) for camera, each in zip(rig.cameras, people, strict=True)]
    assert chosen(rig, people, costs) == (1, 0, 1)


def test_a_person_behind_the_camera_is_far_from_everyone() -> None:
    costs = costs_of(RIG.cameras[0], (ONE[0],), np.array([0.0, 1.0, 40.0]))
    assert costs == [5.0]
