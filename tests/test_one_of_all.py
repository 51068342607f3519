"""A run that follows one person among others: it is never another, and waits for its own."""

import numpy as np
import pytest
from crowd_of_two import BLUE, LEFT_M, RED, RIGHT_M, Crowd, shown
from staging import PERSON

from common.bus.messages import Body
from integrator.measuring.known_body import Measured
from integrator.people.lived_instant import KEPT_S
from integrator.people.recognition import State
from runtime.unfinished.state_codec import packed, unpacked

OWN, OTHER = shown(LEFT_M, (0, 0), RED), shown(RIGHT_M, (1, 1), BLUE)
IN_PLACE = shown(LEFT_M, (1, 1), BLUE)
"""The other, where the followed person stood."""
SECOND = 15


def follower() -> Crowd:
    """A run that has followed a person for a while, beside whom another stands."""
    crowd = Crowd(people=1)
    crowd.last(8, OWN)
    crowd.last(SECOND, OWN, OTHER)
    return crowd


def is_at(bodies: tuple[Body, ...], place_m: tuple[float, float]) -> bool:
    (body,) = bodies
    if body.status not in {"tracking", "measuring"}:
        return False
    x_m, _, z_m = body.joints_m[0]
    return bool(np.hypot(x_m - place_m[0], z_m - place_m[1]) < 0.3)


def test_one_body_of_number_0_is_told_whoever_else_is_there() -> None:
    (body,) = follower().see(OWN, OTHER)
    assert body.person == 0
    assert is_at((body,), LEFT_M)


@pytest.mark.parametrize("away_s", [1.0, 2.0 * KEPT_S])
def test_who_leaves_is_lost_while_another_stays_and_followed_when_they_are_back(
    away_s: float,
) -> None:
    crowd = follower()
    gone = [crowd.see(OTHER) for _ in range(round(away_s * SECOND))]
    assert not any(is_at(bodies, RIGHT_M) for bodies in gone)
    assert [body.status for body in gone[-1]] == ["lost"]
    back = crowd.last(3, shown(LEFT_M, (7, 7), RED), OTHER)
    assert is_at(back, LEFT_M)


def test_another_who_takes_the_place_of_who_left_is_not_followed() -> None:
    crowd = follower()
    crowd.last(SECOND, OTHER)
    after = [crowd.see(IN_PLACE) for _ in range(3 * SECOND)]
    assert not any(is_at(bodies, LEFT_M) for bodies in after)
    assert is_at(crowd.last(3, shown(RIGHT_M, (8, 8), RED), IN_PLACE), RIGHT_M)


def test_who_is_hidden_in_one_view_is_followed_by_the_other() -> None:
    crowd = follower()
    assert is_at(crowd.last(SECOND, shown(LEFT_M, (0, -1), RED), OTHER), LEFT_M)


def test_numbers_that_a_viewer_exchanges_do_not_matter() -> None:
    crowd = follower()
    assert is_at(crowd.last(8, shown(LEFT_M, (0, 1), RED), shown(RIGHT_M, (1, 0), BLUE)), LEFT_M)


def test_an_empty_room_is_empty_and_not_lost() -> None:
    crowd = follower()
    assert [body.status for body in crowd.last(3)] == ["empty"]


def test_who_was_never_believed_is_given_up_for_another() -> None:
    """The first silhouette was of no person: no landmarks of two views confirm it."""
    crowd = Crowd(people=1)
    crowd.see(OWN)
    (life,) = crowd.state.lives
    never = life._replace(joints_m=None, joints_s=-np.inf, tracks=(9, 9))
    crowd.state = crowd.state._replace(lives=(never,))
    assert is_at(crowd.last(2 * SECOND, OTHER), RIGHT_M)


def test_a_saved_state_goes_on_to_the_same_bodies() -> None:
    crowd = follower()
    again = Crowd(people=1)
    again.state, again.n = unpacked(packed(crowd.state), State), crowd.n
    assert again.see(OWN, OTHER) == crowd.see(OWN, OTHER)


def with_body(crowd: Crowd, number: int) -> None:
    """The state in which one of the people was measured in the opening posture."""
    measured = Measured(PERSON, (RIGHT_M[0], 1.0, RIGHT_M[1]))
    first, other = crowd.state.lives
    assert other.number == number
    person = other.state.person._replace(body=measured)
    other = other._replace(state=other.state._replace(person=person))
    crowd.state = crowd.state._replace(lives=(first, other))


def test_who_performs_the_opening_posture_is_followed_once_the_other_is_long_gone() -> None:
    """They may be the same person in other clothes, who is lost for ever otherwise."""
    crowd = follower()
    crowd.last(SECOND, OTHER)
    with_body(crowd, 2)
    soon = crowd.last(round((KEPT_S - 1.5) * SECOND), OTHER)
    assert [body.status for body in soon] == ["lost"]
    crowd.last(SECOND, OTHER)
    assert is_at(crowd.last(SECOND, OTHER), RIGHT_M)
    assert crowd.see(OTHER)[0].person == 0
    assert [life.number for life in crowd.state.lives] == [1]


def test_others_who_are_gone_are_forgotten() -> None:
    crowd = follower()
    assert len(crowd.state.lives) == 2
    crowd.last(round((KEPT_S - 1.0) * SECOND), OWN)
    assert len(crowd.state.lives) == 2
    crowd.last(2 * SECOND, OWN)
    assert [life.number for life in crowd.state.lives] == [1]


def test_an_assumed_rig_does_not_tell_people_apart() -> None:
    """Whoever the views show is the one person."""
    crowd = follower()
    room = crowd.state.room._replace(scale_source="assumed")
    crowd.state = crowd.state._replace(room=room)
    assert is_at(crowd.last(SECOND, OTHER), RIGHT_M)
