"""What was wrong about who is who is put right, after it was so for long enough."""

from crowd_of_two import BLUE, LEFT_M, RED, RIGHT_M
from staging import PERSON
from test_owners import ROOM, life

from integrator.measuring.known_body import Measured, Unknown
from integrator.people.corrections import (
    LONG_S,
    ONE_S,
    SWAPPED_S,
    Double,
    Swap,
    loosened,
    of_one,
    themselves,
)
from integrator.person import Waiting

LIVES = [life(1, LEFT_M, RED), life(2, RIGHT_M, BLUE)]


def test_who_has_anothers_observation_goes_on_without_it_and_anew() -> None:
    lives, known = loosened(LIVES, [(0, 1), (1, 0)], [(0, 1)], ROOM)
    assert known == [(0, -1), (1, 0)]
    assert (lives[0].tracks, lives[0].joints_m) == ((0, -1), None)
    assert lives[0].colours == LIVES[0].colours
    assert lives[1] is LIVES[1]


def test_a_body_that_was_measured_is_kept_where_the_pose_begins_anew() -> None:
    measured = Waiting(Measured(PERSON, (0.0, 1.0, 0.0)))
    one = LIVES[0]._replace(state=LIVES[0].state._replace(person=measured))
    lives, _ = loosened([one, LIVES[1]], [(0, 1), (1, 0)], [(0, 1), (1, 0)], ROOM)
    assert lives[0].state.person == measured
    assert isinstance(lives[1].state.person.body, Unknown)


def test_who_wear_each_others_clothes_for_long_get_their_numbers_back() -> None:
    lives, swaps = themselves(LIVES, [(0, 1)], [], 5.0)
    assert ([one.number for one in lives], swaps) == ([1, 2], (Swap((1, 2), 5.0),))
    lives, swaps = themselves(lives, [(0, 1)], swaps, 5.0 + 0.9 * SWAPPED_S)
    assert [one.number for one in lives] == [1, 2]
    lives, swaps = themselves(lives, [(0, 1)], swaps, 5.0 + SWAPPED_S)
    assert ([one.number for one in lives], swaps) == ([2, 1], ())
    assert lives[0].colours == LIVES[1].colours
    assert lives[0].joints_m is LIVES[0].joints_m, "the body stays where it is"


def test_a_moment_of_doubt_begins_anew() -> None:
    _, swaps = themselves(LIVES, [], [Swap((1, 2), 5.0)], 5.3)
    assert swaps == ()


def test_one_person_taken_for_two_is_the_older() -> None:
    apart, now_s = [(0, -1), (-1, 0)], ONE_S
    lives, known, doubles = of_one(LIVES, apart, [(0, 1)], [], 0.0)
    assert (len(lives), known, doubles) == (2, apart, (Double((1, 2), 0.0),))
    lives, known, _ = of_one(LIVES, apart, [(0, 1)], doubles, now_s)
    assert ([one.number for one in lives], known) == ([1], [(0, 0)])


def test_who_was_known_for_long_is_hidden_and_not_forgotten() -> None:
    apart, now_s = [(0, -1), (-1, 0)], LONG_S
    doubles = (Double((1, 2), now_s - ONE_S),)
    lives, known, _ = of_one(LIVES, apart, [(0, 1)], doubles, now_s)
    assert ([one.number for one in lives], known) == ([1, 2], [(0, 0), (-1, -1)])
