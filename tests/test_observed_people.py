"""What a viewer reports of several people: each one's own joints and pixels."""

from functools import lru_cache

import numpy as np
import pytest
from crowds import Crowd, crowd, whole_people
from test_own_landmarks import seen

from common.body.observation import Landmarks, Observation
from common.config.part_settings import SilhouetteSettings
from common.config.settings import Settings
from common.method import DEFAULT
from common.raster.silhouette_report import unpack
from common.raster.similarity import Mask
from viewer.background.background import learn
from viewer.captured_frame import CapturedFrame
from viewer.landmark_step import State, step
from viewer.landmarks.landmark_window import Window
from viewer.landmarks.person_mask import LandmarkResult, PersonMask, Shown, likeliest
from viewer.people.observed_people import everyone
from viewer.room.silhouette_correction import corrected
from viewer.silhouette import silhouette as silhouettes
from viewer.silhouette.silhouette import Seen

PERSON = Landmarks(((1.0, 2.0),) * 15, (0.9,) * 15)
SHAPE = (48, 48)


def result(left: int, right: int, logit: float = 2.0) -> LandmarkResult:
    """A person in some columns of a picture of SHAPE, one cell a pixel."""
    logits = np.full(SHAPE, -4.0, np.float32)
    logits[4:44, left:right] = logit
    return LandmarkResult(PERSON, PersonMask(logits, Window(0, 0, 48)))


def silhouette(left: int, right: int) -> Seen:
    mask = np.zeros(SHAPE, np.bool_)
    mask[4:44, left:right] = True
    return seen(mask)


def columns(mask: Mask) -> tuple[int, int]:
    held = np.flatnonzero(mask.any(axis=0))
    return int(held[0]), int(held[-1]) + 1


EMPTY = np.full((*SHAPE, 3), 90, np.uint8)


def observed(first: Seen, shown: Shown, least_share: float) -> tuple[Observation, ...]:
    """Everyone before a wall of one colour, where the network alone shows who is where."""
    room = silhouettes.init(learn([EMPTY]), SilhouetteSettings(), DEFAULT)
    return everyone(room, EMPTY, first, shown, least_share)


def test_the_followed_person_is_first_and_others_have_their_own_pixels() -> None:
    shown = Shown(result(4, 20), 3, ((5, result(16, 30, 1.0)), (7, result(28, 44, 3.0))))
    first, second, third = observed(silhouette(4, 20), shown, 0.15)
    assert [each.track for each in (first, second, third)] == [3, 5, 7]
    assert [columns(unpack(each)) for each in (first, second, third)] == [
        (4, 20),
        (20, 28),
        (28, 44),
    ]
    assert {each.landmarks for each in (first, second, third)} == {PERSON}
    assert (second.width, second.height, second.cut) == (48, 48, False)


def test_no_pixel_of_the_followed_silhouette_is_anothers_too() -> None:
    """Also where the network does not say which pixels are the followed person's."""
    unmasked = LandmarkResult(PERSON)
    _, other = observed(silhouette(4, 20), Shown(unmasked, 3, ((5, result(12, 36)),)), 0.15)
    assert columns(unpack(other)) == (20, 36)


def test_a_silhouette_without_landmarks_is_a_person_where_no_landmarks_show_any() -> None:
    (alone,) = observed(silhouette(4, 20), Shown(LandmarkResult(None), 3), 0.15)
    assert (alone.track, alone.landmarks) == (3, None)


def test_another_who_is_too_low_to_be_a_person_is_left_out() -> None:
    low = np.full(SHAPE, -4.0, np.float32)
    low[40:44, 30:40] = 2.0
    small = LandmarkResult(PERSON, PersonMask(low, Window(0, 0, 48)))
    shown = Shown(result(4, 20), 0, ((1, small),))
    assert len(observed(silhouette(4, 20), shown, 0.15)) == 1
    assert len(observed(silhouette(4, 20), shown, 0.05)) == 2


def test_a_pixel_is_anothers_where_they_are_likely_and_likelier() -> None:
    one, other = result(4, 20, 1.0).person, result(10, 30, 2.0).person
    assert one is not None
    assert other is not None
    assert columns(likeliest([other], one, SHAPE) > 0) == (10, 30)
    assert columns(likeliest([one], other, SHAPE) > 0) == (4, 10)
    assert columns(likeliest([one, other], None, SHAPE) > 0) == (4, 30)
    unlikely = result(30, 40, -0.1).person
    assert unlikely is not None
    assert not likeliest([unlikely], one, SHAPE).any()


def test_of_a_region_that_holds_two_people_the_silhouette_is_the_followed_ones() -> None:
    """What is the other's is no thing: it must not become background."""
    other = result(18, 40).person
    assert other is not None
    held = corrected(silhouette(4, 40), result(4, 20, 1.0), 0.15, [other])
    assert held.is_changed
    assert columns(held.seen.mask) == (4, 18)
    assert held.things is None
    apart = corrected(silhouette(4, 18), result(4, 20, 1.0), 0.15, [other])
    assert not apart.is_changed


def two_at(first: tuple[int, int], second: tuple[int, int]) -> tuple[Observation, ...]:
    """Everyone in a picture of a room in which two people stand in some columns; the network sees
    each a column narrower at both sides."""
    picture = EMPTY.copy()
    picture[4:44, slice(*first)] = (10, 10, 200)
    picture[4:44, slice(*second)] = (200, 10, 10)
    room = silhouettes.init(learn([EMPTY]), SilhouetteSettings(), DEFAULT)
    looks = [result(left + 1, right - 1) for left, right in (first, second)]
    near = [((sum(ends) / 2, 24.0),) * 15 for ends in (first, second)]
    looks = [
        look._replace(landmarks=Landmarks(px, (0.9,) * 15))
        for look, px in zip(looks, near, strict=True)
    ]
    shown = Shown(looks[0], 3, ((5, looks[1]),))
    return everyone(room, picture, silhouette(*first), shown, 0.15)


def test_of_everyone_each_has_the_silhouette_that_the_background_shows() -> None:
    first, second = two_at((3, 18), (26, 46))
    assert [each.track for each in (first, second)] == [3, 5]
    assert [columns(unpack(each)) for each in (first, second)] == [(3, 18), (26, 46)]
    assert first.colours[1] > 40.0, "red"
    assert second.colours[2] < -40.0, "blue"


def test_who_stands_beside_another_has_none_of_their_pixels() -> None:
    _, second = two_at((3, 22), (22, 42))
    left, right = columns(unpack(second))
    assert abs(left - 22) <= 2
    assert right in {41, 42}, "all of their own, but a border in doubt"


def test_a_pixel_that_is_likelier_the_followed_persons_is_not_anothers() -> None:
    shown = Shown(result(4, 24, 4.0), 3, ((5, result(16, 36, 2.0)),))
    _, second = observed(silhouette(4, 24), shown, 0.15)
    assert columns(unpack(second)) == (24, 36)


def test_of_everyone_those_without_landmarks_are_left_out_and_the_others_stay() -> None:
    shown = Shown(LandmarkResult(None), 3, ((5, result(16, 30)),))
    found = observed(silhouette(4, 14), shown, 0.15)
    assert [each.track for each in found] == [5]


def test_the_silhouette_of_a_followed_person_who_is_not_seen_takes_no_pixels_of_others() -> None:
    """It is then of whoever is in the picture: here of the other."""
    shown = Shown(LandmarkResult(None), 3, ((5, result(16, 30)),))
    (other,) = observed(silhouette(16, 30), shown, 0.15)
    assert (other.track, columns(unpack(other))) == (5, (16, 30))


@lru_cache(maxsize=1)
def pairs() -> list[tuple[Crowd, tuple[Observation, ...]]]:
    """Ten pictures of two people who stand close, both found at first sight in a region that holds
    both."""
    people, made = whole_people(61_700, 20), list[tuple[Crowd, tuple[Observation, ...]]]()
    for at in range(0, 20, 2):
        scene = crowd(people[at : at + 2], [(115, 225, 150), (195, 230, 160)], at)
        both = seen(scene.masks[0] | scene.masks[1])
        frame = CapturedFrame(0, 0.0, 0.0, scene.picture)
        _, shown = step(State(), frame, both, Settings(), alone=False)
        held = corrected(both, shown.followed, 0.15, shown.masks)
        room = silhouettes.init(learn([scene.picture]), SilhouetteSettings(), DEFAULT)
        made.append((scene, everyone(room, scene.picture, held.seen, shown, 0.15)))
    return made


def off(found: Observation, scene: Crowd, which: int) -> float:
    """Median distance of the joints from a person's, in their size."""
    assert found.landmarks is not None
    true = scene.joints_px[which]
    apart = np.linalg.norm(np.array(found.landmarks.joints_px) - true, axis=1)
    return float(np.median(apart) / np.ptp(true, axis=0).max())


@pytest.mark.slow
def test_of_two_people_close_to_each_other_each_has_their_own_joints_and_pixels() -> None:
    both, near, shared, own = 0, list[float](), list[float](), list[float]()
    for scene, people in pairs():
        both += len(people) == 2
        taken = set[int]()
        for each in people:
            which = min((0, 1), key=lambda at: off(each, scene, at))
            near.append(off(each, scene, which))
            taken.add(which)
            mask = unpack(each)
            true, others = scene.masks[which], scene.masks[1 - which]
            own.append(float((mask & true).sum() / (mask | true).sum()))
            shared.append(float((mask & others).sum() / others.sum()))
        assert len(taken) == len(people), "no two of them are one"
        if len(people) == 2:
            assert not (unpack(people[0]) & unpack(people[1])).any()
    assert both >= 6
    assert np.median(near) < 0.05
    assert np.median(own) > 0.7
    assert np.median(shared) < 0.1
