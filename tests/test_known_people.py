"""Who is who in a viewer from frame to frame: by scenes worked by hand, and laws."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from animator import scene
from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.bus.messages import MOST_PEOPLE
from integrator.people import recognition
from recognizer import everyone
from viewer.people.known_people import (
    GRACE_S,
    PEOPLE,
    Look,
    People,
    corners_of,
    expected_at,
    forgotten,
    is_person,
    is_same,
    of_one,
    step,
)

SHAPE = np.random.default_rng(5).uniform((-15.0, 0.0), (15.0, 100.0), (15, 2))
SHAPE[0], SHAPE[1] = (-15.0, 0.0), (15.0, 100.0)
"""Joints of a person who is 100 pixels tall, about the middle of the top."""


def person(x_px: float, sure: float = 0.8, tall: float = 1.0) -> Landmarks:
    """At a column; tall: in 100 pixels."""
    places = SHAPE * tall + (x_px, 50.0)
    return Landmarks(tuple((float(x), float(y)) for x, y in places), (sure,) * 15)


def column(landmarks: Landmarks) -> float:
    return float(corners_of(landmarks).mean(axis=0)[0])


def known(*columns_px: float) -> People:
    """People who were seen at time 0, numbered from 0; the first is followed."""
    people, _ = step(People(), 0.0, [Look(None, person(x_px)) for x_px in columns_px])
    return people


def numbers(people: People) -> list[int]:
    return [track.number for track in people.tracks]


def test_new_people_get_new_numbers_and_the_first_is_followed() -> None:
    people, given_ = step(People(), 2.0, [Look(None, person(50.0)), Look(None, person(200.0))])
    assert given_ == (0, 1)
    assert (people.followed, people.fresh, numbers(people)) == (0, 2, [0, 1])
    assert people.person is not None
    assert (column(people.person.landmarks), people.person.seen_s) == (50.0, 2.0)
    assert [column(track.landmarks) for track in people.others] == [200.0]


def test_the_largest_of_new_people_is_followed() -> None:
    small, tall = Look(None, person(50.0)), Look(None, person(200.0, tall=1.5))
    people, given_ = step(People(), 0.0, [small, tall])
    assert given_ == (1, 0)
    assert people.person is not None
    assert people.person.landmarks == tall.landmarks


def test_no_more_people_are_known_than_the_bound() -> None:
    looks = [Look(None, person(100.0 * at)) for at in range(PEOPLE + 2)]
    people, given_ = step(People(), 0.0, looks)
    assert sorted(n for n in given_ if n is not None) == [0, 1, 2, 3, 4]
    assert given_.count(None) == 2
    assert people.fresh == PEOPLE


def test_as_many_people_as_a_scene_has_are_known_to_viewers_integrator_recogniser_and_page() -> (
    None
):
    """One more is known to the integrator, who is out of sight and may come back."""
    assert PEOPLE == MOST_PEOPLE < recognition.MOST <= min(everyone.MOST, len(scene.PEOPLE))


def test_two_people_who_pass_each_other_keep_their_numbers() -> None:
    """Before they meet, each is where they were; while one hides the other both looks show the one
    in front, who is where the front one was expected; then the other is found again."""
    people = known(100.0, 160.0)
    for at, (first, second) in enumerate([(108.0, 152.0), (116.0, 144.0), (124.0, 136.0)], 1):
        looks = [Look(0, person(first)), Look(1, person(second))]
        people, given_ = step(people, at / 15, looks)
        if at < 3:
            assert given_ == (0, 1)
    hidden = [Look(0, person(133.0)), Look(1, person(131.0))]  # both show the first
    people, given_ = step(people, 4 / 15, hidden)
    assert sum(number is not None for number in given_) == 1
    assert numbers(people) == [0, 1], "who is hidden is still known"
    looks = [Look(0, person(150.0)), Look(None, person(112.0))]
    people, given_ = step(people, 6 / 15, looks)
    assert given_ == (0, 1)
    assert people.followed == 0


def test_a_look_that_two_claim_is_the_nearer_ones() -> None:
    people = known(100.0, 200.0)
    people, given_ = step(people, 0.1, [Look(0, person(190.0)), Look(1, person(191.0))])
    assert given_ == (None, 1)
    assert people.person is not None
    assert (column(people.person.landmarks), people.person.seen_s) == (100.0, 0.0)


def test_a_look_that_two_claim_about_alike_is_the_followed_persons() -> None:
    looks = [Look(0, person(153.0)), Look(1, person(152.0))]
    assert step(known(100.0, 200.0), 0.1, looks)[1] == (0, None)
    looks = [Look(0, person(158.0)), Look(1, person(159.0))]
    assert step(known(100.0, 200.0), 0.1, looks)[1] == (None, 1)


def test_after_the_followed_person_the_largest_other_is_followed() -> None:
    people, _ = step(known(100.0), 0.1, [Look(0, person(100.0)), Look(None, person(200.0))])
    looks = [Look(0, person(100.0)), Look(1, person(200.0)), Look(None, person(300.0, tall=1.4))]
    people, _ = step(people, 0.2, looks)
    looks = [Look(1, person(200.0)), Look(2, person(300.0, tall=1.4))]
    people, _ = step(people, 1.3, looks)
    assert (people.followed, numbers(people)) == (2, [1, 2])


def test_a_followed_person_out_of_sight_is_waited_for_and_then_another_is_followed() -> None:
    people = known(100.0, 200.0)
    for at_s in (0.3, 0.6, 0.9):
        people, _ = step(people, at_s, [Look(1, person(200.0))])
        assert (people.followed, numbers(people)) == (0, [0, 1])
    people, _ = step(people, 1.2, [Look(1, person(200.0))])
    assert (people.followed, numbers(people)) == (1, [1])


def test_a_number_is_never_used_again() -> None:
    people = known(100.0)
    people, _ = step(people, GRACE_S + 0.1, [])
    assert (people.tracks, people.followed) == ((), 1)
    people, given_ = step(people, GRACE_S + 0.2, [Look(None, person(100.0))])
    assert given_ == (1,)
    assert forgotten(people) == People((), 2, 3)
    assert forgotten(People()) == People()
    again, _ = step(People(), 5.0, [])
    assert again == People(), "a viewer that has known no person yet begins with 0"


@pytest.mark.parametrize(
    ("moved_px", "after_s", "tall", "number"),
    [(25.0, 0.1, 1.0, 0), (70.0, 0.5, 1.0, 0), (70.0, 0.1, 1.0, 2), (10.0, 0.1, 1.7, 2)],
)
def test_a_person_is_found_again_near_the_last_place_and_as_large(
    moved_px: float, after_s: float, tall: float, number: int
) -> None:
    """Farther the longer they were out of sight."""
    people = known(100.0, 300.0)
    looks = [Look(1, person(300.0)), Look(None, person(100.0 + moved_px, tall=tall))]
    _, given_ = step(people, after_s, looks)
    assert given_ == (1, number)


def test_the_integrators_person_is_followed_where_it_is_plainly_another() -> None:
    people = known(100.0, 200.0)

    def pelvis_of(x_px: float) -> tuple[float, float]:
        return person(x_px).joints_px[JOINT_NAMES.index("pelvis")]

    assert expected_at(people, None) is people
    assert expected_at(people, pelvis_of(110.0)).followed == 0
    assert expected_at(people, pelvis_of(195.0)).followed == 1
    assert expected_at(people, pelvis_of(230.0)).followed == 0, "too far from both"
    near = known(100.0, 120.0)
    assert expected_at(near, pelvis_of(121.0)).followed == 0, "hardly nearer to the other"
    assert expected_at(known(100.0), pelvis_of(300.0)).followed == 0
    assert expected_at(of_one(None), pelvis_of(300.0)) == People()


def test_looks_are_of_one_person_by_the_joints_that_both_are_sure_of() -> None:
    assert is_same(person(100.0), person(114.0))
    assert not is_same(person(100.0), person(116.0))
    unsure = Landmarks(person(100.0).joints_px, (0.8,) * 2 + (0.0,) * 13)
    assert is_same(unsure, person(100.0))
    assert not is_same(unsure, person(130.0))


def test_a_person_is_what_is_sure_enough() -> None:
    assert is_person(person(0.0, 0.31))
    assert not is_person(person(0.0, 0.29))
    assert not is_person(None)


Moment = st.tuples(
    st.floats(0.02, 0.7), st.lists(st.tuples(st.integers(0, 4), st.floats(0, 400)), max_size=5)
)


@given(st.lists(Moment, max_size=12))
def test_whatever_is_seen_numbers_are_of_one_person_each_and_only_grow(
    moments: list[tuple[float, list[tuple[int, float]]]],
) -> None:
    people, at_s, ended = People(), 0.0, set[int]()
    for after_s, seen in moments:
        at_s += after_s
        mine = [track.number for track in people.tracks]
        looks = [Look(mine[at] if at < len(mine) else None, person(x)) for at, x in seen]
        before, (people, given_) = people, step(people, at_s, looks)
        told = [number for number in given_ if number is not None]
        assert len(told) == len(set(told))
        assert len(people.tracks) <= PEOPLE
        assert people.fresh >= before.fresh
        assert all(number < people.fresh for number in [*numbers(people), people.followed])
        assert not ended & {*numbers(people), *told}
        ended |= {*numbers(before)} - {*numbers(people)}
        if before.person is not None and people.followed != before.followed:
            assert at_s - before.person.seen_s > GRACE_S
        if people.tracks:
            assert people.person is not None
        assert all(math.isfinite(track.seen_s) for track in people.tracks)
