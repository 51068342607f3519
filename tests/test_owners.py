"""Whose each observation is: near who is known, and of one person where sight lines meet."""

import msgspec
import numpy as np
import pytest
from crowd_of_two import BLUE, LEFT_M, RED, RIGHT_M, pose_at, shown
from staging import PERIOD_S, PERSON, RIG

from common.body.clothes import colour_distance
from common.body.kinematics import joints
from common.body.observation import Observation
from common.body.proportions import body_vector
from common.config.settings import Settings
from common.method import DEFAULT
from integrator import merge_state
from integrator.people import owners
from integrator.people.known_life import Life
from integrator.people.observation_cost import (
    AWAY_S,
    NEAR_M,
    OTHER_CLOTHES,
    UNLIKE,
    cost_of,
    hidden_shares,
    off_m,
)
from integrator.people.owners import SURE_AFTER, Owned, exchanged, mistaken, owned
from integrator.people.sight_gaps import (
    GAP_COLOUR_M,
    INSTANTS,
    Gap,
    People,
    with_instant,
)

ROOM = merge_state.init(RIG, PERIOD_S, Settings(people="all"), DEFAULT)
FIRST, SECOND = (
    tuple(one for one in shown(place, tracks, colours) if one is not None)
    for place, tracks, colours in ((LEFT_M, (0, 0), RED), (RIGHT_M, (1, 1), BLUE))
)
BOTH = list(zip(FIRST, SECOND, strict=True))
"""Of each view, the first and the second."""


def life(number: int, place_m: tuple[float, float], colours: tuple[float, ...] = ()) -> Life:
    joints_m = np.asarray(joints(body_vector(PERSON), pose_at(place_m)))
    known = Life(number, ROOM, 0.0, 1.0, (number - 1,) * 2, (1.0, 1.0))
    return known._replace(joints_m=joints_m, joints_s=1.0, colours=(colours,) * 2)


def gaps_of(people: People, instants: int = 1) -> tuple[Gap, ...]:
    gaps: tuple[Gap, ...] = ()
    for _ in range(instants):
        gaps = with_instant(gaps, RIG, people)
    return gaps


def owned_now(people: People, lives: list[Life], now_s: float = 1.0) -> Owned:
    return owned(RIG, people, lives, now_s, gaps_of(people))


def test_the_known_get_their_own_in_any_order() -> None:
    lives = [life(1, LEFT_M), life(2, RIGHT_M)]
    assert owned_now(BOTH, lives).known == ((0, 0), (1, 1))
    turned = [BOTH[0], BOTH[1][::-1]]
    assert owned_now(turned, lives).known == ((0, 1), (1, 0))
    assert owned_now(turned, lives[::-1]).known == ((1, 0), (0, 1))


def test_strangers_are_grouped_by_sight_lines_and_the_groups_are_clear() -> None:
    found = owned_now([BOTH[0], BOTH[1][::-1]], [])
    assert sorted(group.indices for group in found.groups) == [(0, 1), (1, 0)]
    assert all(group.is_clear for group in found.groups)


def test_a_gap_is_that_of_sight_lines_and_what_colours_differ() -> None:
    own = {gap.tracks: gap.mean_m for gap in gaps_of(BOTH)}
    assert len(own) == 4
    assert own[((0, 0), (1, 0))] < 0.01
    plain = [[msgspec.structs.replace(one, colours=()) for one in view] for view in BOTH]
    bare = {gap.tracks: gap.mean_m for gap in gaps_of(plain)}
    assert bare[((0, 0), (1, 1))] > 0.2
    more_m = own[((0, 0), (1, 1))] - bare[((0, 0), (1, 1))]
    assert more_m == pytest.approx(GAP_COLOUR_M * colour_distance(RED, BLUE))


def test_gaps_are_the_mean_of_the_last_instants() -> None:
    known = [Gap(((0, 0), (1, 0)), 0.6, 2), Gap(((0, 0), (1, 1)), 0.0, INSTANTS)]
    gaps = {gap.tracks: gap for gap in with_instant(known, RIG, BOTH)}
    own = gaps[((0, 0), (1, 0))]
    assert own.mean_m == pytest.approx(0.4, abs=0.01)
    assert own.instants == 3
    (other,) = (gap for gap in gaps_of(BOTH) if gap.tracks == ((0, 0), (1, 1)))
    late = gaps[((0, 0), (1, 1))]
    assert late.mean_m == pytest.approx(other.mean_m / INSTANTS)
    assert late.instants == INSTANTS


def test_the_gaps_of_who_is_not_seen_are_forgotten() -> None:
    gaps = with_instant(gaps_of(BOTH), RIG, [BOTH[0], (FIRST[1],)])
    assert {gap.tracks for gap in gaps} == {((0, 0), (1, 0)), ((0, 1), (1, 0))}


def test_two_whose_sight_lines_meet_both_ways_are_not_clear() -> None:
    alike = [BOTH[0], (FIRST[1], msgspec.structs.replace(FIRST[1], track=5))]
    found = owned_now(alike, [])
    assert not any(group.is_clear for group in found.groups if -1 not in group.indices)


def gap(one: tuple[int, int], other: tuple[int, int], mean_m: float) -> Gap:
    """Of two tracks, each a view and a number."""
    return Gap((one, other), mean_m, INSTANTS, mean_m)


def test_strangers_are_grouped_so_that_all_gaps_together_are_least() -> None:
    """The nearest two are of different people: the two that they leave are farther apart."""
    gaps = (
        gap((0, 0), (1, 0), 0.031),
        gap((0, 0), (1, 1), 0.039),
        gap((0, 1), (1, 0), 0.038),
        gap((0, 1), (1, 1), 0.079),
    )
    found = owned(RIG, BOTH, [], 1.0, gaps)
    assert sorted(group.indices for group in found.groups) == [(0, 1), (1, 0)]


def test_strangers_of_three_views_are_grouped_where_all_their_sight_lines_meet() -> None:
    """The third view's meets those of the first and not of the second."""
    rig = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    for third_m, expected in ((0.05, [(0, 0, 0)]), (0.2, [(-1, -1, 0), (0, 0, -1)])):
        gaps = (
            gap((0, 0), (1, 0), 0.03),
            gap((0, 0), (2, 0), 0.04),
            gap((1, 0), (2, 0), third_m),
        )
        people = [[FIRST[0]], [FIRST[1]], [FIRST[0]]]
        found = owned(rig, people, [], 1.0, gaps)
        assert sorted(group.indices for group in found.groups) == expected


@pytest.mark.parametrize(
    ("own_m", "rival_m", "own"),
    [(0.06, 0.021, -1), (0.06, 0.05, 0), (0.06, 0.035, 0), (0.03, 0.012, 0)],
    ids=["clearly", "hardly", "not by half", "not by two centimetres"],
)
def test_a_newcomer_who_is_nearer_to_another_is_not_taken_for_who_that_view_lacks(
    own_m: float, rival_m: float, own: int
) -> None:
    """View 2 shows the known person and one who has just come, view 1 the latter alone."""
    known = life(1, (LEFT_M[0] + 1.0, LEFT_M[1]))._replace(tracks=(9, 0))
    assert cost_of(RIG.cameras[0], 0, known, FIRST[0], 1.0) == np.inf
    gaps = gap((0, 0), (1, 0), own_m), gap((0, 0), (1, 1), rival_m)
    assert owned(RIG, [[FIRST[0]], BOTH[1]], [known], 1.0, gaps).known == ((own, 0),)


def test_a_view_that_does_not_know_who_it_shows_is_asked_by_sight_lines() -> None:
    """The person is expected a metre away in view 2 alone: its sight lines meet view 1's."""
    known = life(1, LEFT_M)._replace(tracks=(0, 9))
    costs = [cost_of(camera, n, known, BOTH[n][0], 1.0) for n, camera in enumerate(RIG.cameras)]
    assert max(costs) < 1.0
    moved = life(1, (LEFT_M[0], LEFT_M[1] + 1.0))._replace(tracks=(0, 9))
    assert cost_of(RIG.cameras[1], 1, moved, FIRST[1], 1.0) == np.inf
    assert owned_now([[FIRST[0]], [FIRST[1]]], [moved]).known == ((0, 0),)
    assert owned_now([[FIRST[0]], [SECOND[1]]], [moved]).known == ((0, -1),)


def test_a_view_that_shows_one_of_two_is_told_by_the_others_sight_lines_who_it_is() -> None:
    """View 1 shows the second alone, with the number that it gave the first, and nearer to where
    the first is expected: its sight lines meet those of view 2 that show the second."""
    lives = [
        life(1, (RIGHT_M[0] - 0.15, LEFT_M[1]))._replace(tracks=(1, 0)),
        life(2, (RIGHT_M[0] + 0.1, RIGHT_M[1]))._replace(tracks=(9, 1)),
    ]
    people = [(SECOND[0],), BOTH[1]]
    own, theirs = (cost_of(RIG.cameras[0], 0, each, SECOND[0], 1.0) for each in lives)
    assert own < theirs
    assert owned_now(people, lives).known == ((-1, 0), (0, 1))
    assert owned(RIG, people, lives, 1.0, ()).known[0] == (0, 0), "no gap is known"


def test_two_views_that_never_meet_are_not_of_one_person_however_near_they_are() -> None:
    """In each view the observation is where the one known person is expected."""
    known = life(1, (RIGHT_M[0], LEFT_M[1]))
    people = [(SECOND[0],), (FIRST[1],)]
    costs = [cost_of(RIG.cameras[n], n, known, people[n][0], 1.0) for n in range(2)]
    assert max(costs) < 0.5
    assert sorted(owned_now(people, [known]).known[0]) == [-1, 0]


def test_who_has_anothers_observation_is_found_after_a_third_of_a_second() -> None:
    crossed = [(0, 1), (1, 0)]
    assert mistaken(BOTH, crossed, gaps_of(BOTH, SURE_AFTER - 1)) == []
    assert mistaken(BOTH, crossed, gaps_of(BOTH, SURE_AFTER)) == [(0, 1), (1, 1)]
    assert mistaken(BOTH, [(0, 0), (1, 1)], gaps_of(BOTH, SURE_AFTER)) == []
    assert mistaken(BOTH, [(0, -1), (1, 0)], gaps_of(BOTH, SURE_AFTER)) == [(1, 1)]


def test_a_rival_that_is_hardly_nearer_takes_nobody() -> None:
    def gap(first: int, second: int, mean_m: float) -> Gap:
        return Gap(((0, first), (1, second)), mean_m, SURE_AFTER)

    def found(own_m: float, rival_m: float) -> list[tuple[int, int]]:
        gaps = [gap(0, 0, own_m), gap(0, 1, rival_m), gap(1, 0, 0.3), gap(1, 1, 0.3)]
        return mistaken(BOTH, [(0, 0)], gaps)

    assert found(0.10, 0.06) == []
    assert found(0.10, 0.04) == [(0, 1)]
    assert found(0.03, 0.012) == []


def test_an_observation_is_as_far_as_the_person_has_moved_across_the_picture() -> None:
    """Camera 1 looks along -z: a metre along x is a metre in it, at the person's depth."""
    for off in (0.25, -1.0):
        known = life(1, (LEFT_M[0] + off, LEFT_M[1])).joints_m
        assert known is not None
        assert off_m(RIG.cameras[0], known, FIRST[0]) == pytest.approx(abs(off), rel=0.05)
    known = life(1, (0.0, 9.0)).joints_m
    assert known is not None
    assert off_m(RIG.cameras[0], known, FIRST[0]) == np.inf


def test_who_is_out_of_sight_may_be_farther_but_not_in_other_clothes() -> None:
    away = life(1, (LEFT_M[0] + 1.5 * NEAR_M, LEFT_M[1]), RED)
    camera = RIG.cameras[0]
    assert cost_of(camera, 0, away, FIRST[0], 1.0) == np.inf
    assert cost_of(camera, 0, away, FIRST[0], 1.0 + 2 * AWAY_S) < 1.0
    other = msgspec.structs.replace(FIRST[0], colours=BLUE)
    assert cost_of(camera, 0, away, other, 1.0 + 2 * AWAY_S) == np.inf
    near = life(1, LEFT_M, RED)
    assert cost_of(camera, 0, near, other, 1.0) < 1.0, "light changes colours"


def test_colours_of_another_camera_may_differ_more_than_a_cameras_own() -> None:
    """.1 to .4 for one person in two cameras, .05 in one."""
    lighter = (RED[0] + 28.0, *RED[1:3], RED[3] + 28.0, *RED[4:])
    seen = msgspec.structs.replace(FIRST[0], colours=lighter)
    assert OTHER_CLOTHES < colour_distance(RED, seen.colours) < UNLIKE
    later_s = 1.0 + 2 * AWAY_S
    own = life(1, LEFT_M, RED)
    others = own._replace(colours=((), RED))
    assert cost_of(RIG.cameras[0], 0, own, seen, later_s) == np.inf
    assert cost_of(RIG.cameras[0], 0, others, seen, later_s) < 1.0


def test_the_viewers_number_decides_between_two_as_near() -> None:
    one, two = life(1, LEFT_M), life(1, LEFT_M)._replace(tracks=(4, 4))
    seen = FIRST[0]
    assert cost_of(RIG.cameras[0], 0, one, seen, 1.0) <= cost_of(RIG.cameras[0], 0, two, seen, 1.0)
    moved = life(1, (LEFT_M[0] + 0.3, LEFT_M[1]))
    assert cost_of(RIG.cameras[0], 0, moved, seen, 1.0) < cost_of(
        RIG.cameras[0], 0, moved._replace(tracks=(4, 4)), seen, 1.0
    )


def test_two_who_are_never_in_one_view_and_in_one_place_may_be_one() -> None:
    lives = [life(1, LEFT_M, RED), life(2, LEFT_M, RED)]
    apart = [(0, -1), (-1, 0)]
    people = [[FIRST[0]], [FIRST[1]]]
    assert owners.doubles(RIG, people, lives, apart, 1.0) == [(0, 1)]
    assert owners.doubles(RIG, people, lives, [(0, 0), (-1, 0)], 1.0) == []
    assert owners.doubles(RIG, [[FIRST[0]], [SECOND[1]]], lives, apart, 1.0) == []
    others = [lives[0], life(2, LEFT_M, BLUE)]
    assert owners.doubles(RIG, people, others, apart, 1.0) == []


def test_two_who_are_expected_in_different_places_are_two_though_their_sight_lines_meet() -> None:
    people = [[FIRST[0]], [FIRST[1]]]
    near_m, far_m = ((LEFT_M[0], LEFT_M[1] - share * NEAR_M) for share in (0.9, 1.1))
    for place_m, found in ((near_m, [(0, 1)]), (far_m, [])):
        lives = [life(1, LEFT_M, RED), life(2, place_m, RED)]
        assert owners.doubles(RIG, people, lives, [(0, -1), (-1, 0)], 1.0) == found
    unknown = life(2, far_m, RED)._replace(joints_m=None)
    lives = [life(1, LEFT_M, RED), unknown]
    assert owners.doubles(RIG, people, lives, [(0, -1), (-1, 0)], 1.0) == [(0, 1)]


def test_a_look_that_shows_nobody_is_no_stranger() -> None:
    def unsure(one: Observation) -> Observation:
        assert one.landmarks is not None
        low = msgspec.structs.replace(one.landmarks, confidence=(0.1,) * 15)
        return msgspec.structs.replace(one, landmarks=low)

    people = [[unsure(FIRST[0])], [unsure(FIRST[1])]]
    assert owned_now(people, []).groups == ()


def test_who_wear_each_others_clothes_were_taken_for_each_other() -> None:
    lives = [life(1, LEFT_M, RED), life(2, RIGHT_M, BLUE)]
    own, crossed = [(0, 0), (1, 1)], [(1, 1), (0, 0)]
    assert exchanged(BOTH, lives, own) == []
    assert exchanged(BOTH, lives, crossed) == [(0, 1)]
    assert exchanged(BOTH, lives, [(1, -1), (0, -1)]) == [(0, 1)]
    assert exchanged(BOTH, lives, [(1, -1), (-1, 0)]) == [], "never in one view"
    alike = [life(1, LEFT_M, RED), life(2, RIGHT_M, RED)]
    assert exchanged(BOTH, alike, crossed) == []
    mixed = [(1, 0), (0, 1)]
    assert exchanged(BOTH, lives, mixed) == [], "one view says so, the other not"


def test_colours_differ_by_the_mean_of_both_parts() -> None:
    assert colour_distance((50.0, 0.0, 0.0) * 2, (50.0, 30.0, 40.0, 50.0, 0.0, 0.0)) == 25.0 / 40.0
    assert colour_distance((), RED) == 0.0
    assert colour_distance(RED, BLUE) > UNLIKE


BEHIND_M, BEFORE_M = (0.0, -0.6), (0.0, 0.6)
"""Places in one line of sight of camera 1."""


def test_who_stands_behind_another_is_hidden_in_that_view_alone() -> None:
    far, near = (life(n, place).joints_m for n, place in enumerate((BEHIND_M, BEFORE_M)))
    hidden, shown_whole = hidden_shares(RIG.cameras[0], [far, near])
    assert hidden > 0.9
    assert shown_whole == 0.0
    assert hidden_shares(RIG.cameras[1], [far, near]).max() < 0.4
    assert hidden_shares(RIG.cameras[0], [far, None]).tolist() == [0.0, 0.0]


def test_two_in_one_place_hide_neither() -> None:
    """They may be one person: a sixth of a metre of depth is within the error of one view."""
    near = [life(n, (0.0, 0.15 * n)).joints_m for n in range(2)]
    assert hidden_shares(RIG.cameras[0], near).tolist() == [0.0, 0.0]


def test_the_one_person_whom_a_view_shows_of_two_in_line_is_the_nearer() -> None:
    """Whatever number the viewer gives them: it lost the other there."""
    lives = [life(1, BEHIND_M), life(2, BEFORE_M)]
    front, side = (shown(place, (0, n), ()) for n, place in enumerate((BEFORE_M, BEHIND_M)))
    views = [[front[0]], [front[1], side[1]]]
    people: People = [[one for one in view if one is not None] for view in views]
    assert [own[0] for own in owned_now(people, lives).known] == [-1, 0]
