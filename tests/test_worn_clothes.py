"""Whose numbers people have who crossed: those of who wears the clothes."""

import pytest

from common.body.clothes import ALIKE, COLOUR_SCALE, colour_distance, exchange_gain
from common.body.observation import Box, Landmarks, Observation
from viewer.people.known_people import People, Track
from viewer.people.worn_clothes import NEW_SHARE, step

RED, BLUE = (50.0, 60.0, 40.0) * 2, (40.0, 10.0, -60.0) * 2
LEFT, RIGHT, OVER_LEFT = Box(10, 30, 20, 100), Box(60, 80, 20, 100), Box(20, 40, 20, 100)


def seen(number: int, box: Box, colours: tuple[float, ...]) -> Observation:
    return Observation(
        track=number, width=160, height=120, silhouette=b"", box=box, area_px=1, colours=colours
    )


def track(number: int, seen_s: float = 0.0) -> Track:
    """Whose joints are all in one place, which says which track it was."""
    return Track(number, Landmarks(((float(number), 0.0),) * 15, (0.9,) * 15), seen_s)


def met(*observations: Observation, people: People | None = None) -> People:
    """Two people after some frames of observations."""
    people = people or People((track(3), track(5)), 3, 6)
    for _ in range(10):
        people, _ = step(people, observations)
    return people


KNOWN = met(seen(3, LEFT, RED), seen(5, RIGHT, BLUE))


def test_clothes_are_learnt_where_all_are_seen_apart() -> None:
    assert [(each.number, each.frames) for each in KNOWN.clothes] == [(3, 10), (5, 10)]
    assert KNOWN.clothes[0].colours == pytest.approx(RED)
    assert met(seen(3, LEFT, RED), seen(5, OVER_LEFT, BLUE)).clothes == ()
    assert met(seen(3, LEFT, RED)).clothes == (), "the other may be behind them"


def test_clothes_follow_the_light_by_a_fiftieth_a_frame_once_they_are_known() -> None:
    """As a mean of all frames at first."""
    darker = tuple(0.8 * each for each in RED)
    two = met(seen(3, LEFT, RED), seen(5, RIGHT, BLUE), people=KNOWN._replace(clothes=()))
    assert two.clothes == KNOWN.clothes
    once, _ = step(two, (seen(3, LEFT, darker), seen(5, RIGHT, BLUE)))
    assert once.clothes[0].colours == pytest.approx([r - 0.2 * r / 11 for r in RED])
    assert once.clothes[0].frames == 11
    old = two._replace(clothes=tuple(each._replace(frames=1000) for each in two.clothes))
    later, _ = step(old, (seen(3, LEFT, darker), seen(5, RIGHT, BLUE)))
    assert later.clothes[0].colours == pytest.approx([r - 0.2 * r * NEW_SHARE for r in RED])
    assert later.clothes[1].colours == pytest.approx(BLUE)


def test_clothes_without_colours_and_of_who_is_no_longer_known_are_not_kept() -> None:
    people, _ = step(KNOWN, (seen(3, LEFT, ()), seen(5, RIGHT, BLUE)))
    assert [each.frames for each in people.clothes] == [10, 11]
    gone, _ = step(KNOWN._replace(tracks=(track(3),)), (seen(3, LEFT, RED),))
    assert [each.number for each in gone.clothes] == [3]


@pytest.mark.parametrize("turned", [False, True])
def test_one_above_the_other_is_apart(turned: bool) -> None:
    """A balcony: the same columns of the picture, other rows."""
    above, below = Box(10, 30, 10, 50), Box(15, 35, 51, 90)
    boxes = (below, above) if turned else (above, below)
    people = met(seen(3, boxes[0], RED), seen(5, boxes[1], BLUE))
    assert [each.number for each in people.clothes] == [3, 5]
    touching = Box(15, 35, 50, 90)
    assert met(seen(3, above, RED), seen(5, touching, BLUE)).clothes == ()


def test_two_who_wear_each_others_clothes_get_their_numbers_back() -> None:
    people, found = step(KNOWN, (seen(3, LEFT, BLUE), seen(5, OVER_LEFT, RED)))
    assert [(one.track, one.box) for one in found] == [(3, OVER_LEFT), (5, LEFT)], "followed first"
    assert [each.landmarks.joints_px[0][0] for each in people.tracks] == [5.0, 3.0]
    assert [each.number for each in people.tracks] == [3, 5]
    assert people.followed == 3


def test_the_one_whom_a_view_shows_has_the_number_of_who_wears_the_clothes() -> None:
    """The other is hidden by them, and keeps a number."""
    people = KNOWN._replace(tracks=(track(3, 1.0), track(5, 0.5)))
    after, found = step(people, (seen(3, LEFT, BLUE),))
    assert [one.track for one in found] == [5]
    assert [(each.number, each.seen_s) for each in after.tracks] == [(3, 0.5), (5, 1.0)]


def test_who_wears_their_own_or_no_others_clothes_keeps_the_number() -> None:
    half = tuple(0.5 * (a + b) for a, b in zip(RED, BLUE, strict=True))
    for colours in (RED, half, (0.0, 0.0, 0.0) * 2, ()):
        _, found = step(KNOWN, (seen(3, LEFT, colours), seen(5, RIGHT, BLUE)))
        assert [one.track for one in found] == [3, 5]


def test_clothes_that_are_alike_tell_nobody_apart() -> None:
    nearly = (RED[0] + 0.9 * ALIKE * COLOUR_SCALE, *RED[1:3]) * 2
    assert colour_distance(RED, nearly) == pytest.approx(0.9 * ALIKE)
    assert exchange_gain(RED, nearly, nearly, RED) == 0.0
    assert exchange_gain(RED, BLUE, BLUE, RED) == pytest.approx(1.0)
    assert exchange_gain(RED, BLUE, RED, ()) == pytest.approx(-1.0)
