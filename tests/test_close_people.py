"""People who are close in a picture: each is looked at alone, and nobody gets another's limbs."""

import numpy as np
import pytest
from crowds import crowd, whole_people
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from common.body.body import Floats
from common.body.observation import Landmarks
from viewer.landmarks.landmark_window import GREY, Window
from viewer.landmarks.own_landmarks import look_in, window_of_joints
from viewer.landmarks.person_mask import LandmarkResult
from viewer.people.close_people import (
    AROUND,
    are_together,
    beside,
    cheapest,
    close_part_px,
    is_in,
    without,
)
from viewer.people.known_people import People, Track

COSTS = st.integers(0, 4).flatmap(
    lambda columns: st.lists(
        st.lists(st.integers(0, 20), min_size=columns, max_size=columns), max_size=4
    )
)


@given(COSTS)
def test_the_cheapest_pairs_cost_what_those_of_scipy_do(costs: list[list[int]]) -> None:
    most = 10
    found = cheapest([[float(cost) for cost in row] for row in costs], most)
    columns = [column for column in found if column is not None]
    assert len(columns) == len(set(columns))
    width = len(costs[0]) if costs else 0
    table = np.minimum(np.array(costs, float).reshape(len(costs), width), most)
    rows, best = linear_sum_assignment(table)
    own = sum(costs[row][column] for row, column in enumerate(found) if column is not None)
    alone = min(len(costs), width) - len(columns)
    assert own + most * alone == table[rows, best].sum()


def test_a_pair_that_costs_more_is_none() -> None:
    assert cheapest([[0.5, 0.2], [0.1, 0.9]], 0.4) == [1, 0]
    assert cheapest([[0.5], [0.3]], 0.4) == [None, 0]
    assert cheapest([], 0.4) == []
    assert cheapest([[]], 0.4) == [None]


def figure(x_px: float) -> Landmarks:
    """Somebody upright, 100 pixels high."""
    at = [(0, 0), (0, -35), (0, -55), (9, -32), (12, -14), (12, 4), (5, 0), (5, 22), (5, 45)]
    at += [(-9, -32), (-12, -14), (-12, 4), (-5, 0), (-5, 22), (-5, 45)]
    return Landmarks(tuple((x_px + x, 100.0 + y) for x, y in at), (0.9,) * 15)


def test_only_pixels_of_others_and_none_of_the_persons_are_grey() -> None:
    picture = np.zeros((160, 200, 3), np.uint8)
    own, other, far = figure(60.0), figure(80.0), figure(190.0)
    theirs = beside(picture, 1, {1: own, 2: other, 3: far})
    assert theirs is not None
    assert (theirs[100, 80], theirs[100, 60], theirs[80, 62], theirs[100, 190]) == (1, 0, 0, 0)
    alone = without(picture, theirs)
    assert (alone[100, 80] == GREY).all()
    assert not alone[100, 60].any()
    assert not picture.any(), "the picture itself is left"
    assert beside(picture, 1, {1: own, 3: far}) is None
    assert without(picture, None) is picture


def test_who_reaches_into_a_window_is_in_it() -> None:
    other = figure(80.0)  # columns 68 to 92, rows 45 to 145
    assert is_in(Window(60, 50, 30), other)
    assert not is_in(Window(20, 50, 48), other)
    assert not is_in(Window(92, 50, 48), other)
    assert not is_in(Window(60, 146, 48), other)
    assert not is_in(Window(60, 0, 45), other)


def test_people_are_close_where_one_is_in_the_others_window() -> None:
    def people(*columns: float) -> People:
        tracks = tuple(Track(n, figure(x), 0.0) for n, x in enumerate(columns))
        return People(tracks, 0, len(columns))

    found = close_part_px(people(60.0, 100.0, 260.0))
    assert found is not None
    beyond = AROUND * 100.0
    assert found[0].tolist() == pytest.approx([48.0 - beyond, 45.0 - beyond])
    assert found[1].tolist() == pytest.approx([112.0 + beyond, 145.0 + beyond])
    assert close_part_px(people(60.0, 260.0)) is None
    assert close_part_px(people(60.0)) is None


@pytest.mark.parametrize(
    ("columns", "together"),
    [((60.0, 80.0), True), ((60.0, 93.0), True), ((60.0, 95.0), False), ((60.0,), False)],
    ids=["overlap", "a tenth of their height apart", "farther", "one person"],
)
def test_people_are_together_where_their_boxes_meet(
    columns: tuple[float, ...], together: bool
) -> None:
    """Each is 24 pixels wide and 100 high."""
    for order in (1, -1):
        tracks = tuple(Track(n, figure(x), 0.0) for n, x in enumerate(columns[::order]))
        assert are_together(People(tracks, 0, len(columns))) == together


def right_share(look: LandmarkResult, own_px: Floats) -> float:
    """Share of the joints that are within a fifteenth of the height."""
    if look.landmarks is None:
        return 0.0
    off_px = np.linalg.norm(np.array(look.landmarks.joints_px) - own_px, axis=1)
    return float((off_px < 10.0).mean())


@pytest.mark.slow
def test_of_two_side_by_side_more_joints_are_theirs_than_where_both_are_seen() -> None:
    """Where they are is known from their true joints: what is tested is the look."""
    people = whole_people(90, 24)
    alone, together = [], []
    for n in range(12):
        scene = crowd(people[2 * n : 2 * n + 2], [(135, 200, 150), (172, 205, 150)], n)
        own = {
            place: Landmarks(tuple((x, y) for x, y in joints_px.tolist()), (0.9,) * 15)
            for place, joints_px in enumerate(scene.joints_px)
        }
        for place, joints_px in enumerate(scene.joints_px):
            window = window_of_joints(own[place])
            assert window is not None
            theirs = beside(scene.picture, place, own)
            grey = look_in(without(scene.picture, theirs), window)
            alone.append(right_share(grey, joints_px))
            together.append(right_share(look_in(scene.picture, window), joints_px))
    assert np.mean(alone) > np.mean(together) + 0.05
    assert np.mean(alone) > 0.7
