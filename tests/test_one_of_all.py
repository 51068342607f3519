"""A run that follows one person among others: it is never another, and waits for its own."""

import numpy as np
import pytest
from crowd_of_two import BLUE, LEFT_M, RED, RIGHT_M, Crowd, shown

from common.bus.messages import Body
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
