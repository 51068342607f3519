"""One person in all views of an uncalibrated rig, of views that show several."""

from collections.abc import Callable, Sequence

import msgspec
import numpy as np
import pytest
from many_views import around, shown
from sights_as_views import instant_of

from calibration.tracks import one_of_several
from calibration.tracks.joint_tracks import JointTrack, Sightings, track_of
from calibration.tracks.one_of_several import ALIKE, person_tracks
from common.bus.messages import View

RIG = around(3)
WALKS = shown(RIG, 11, "walk_toward")
SQUATS = shown(RIG, 12, "squat")
COUNT = min(len(track.times_s) for seen in (WALKS, SQUATS) for track in seen.tracks)


def views_of(
    order: Sequence[Sequence[int]], both: Sequence[bool] = (True,) * COUNT
) -> list[list[View]]:
    """Of each camera, all frames: two people, in an order of its own; their numbers are their
    places in it. Frames in which not both are there show the first alone."""
    found: list[list[View]] = [[] for _ in order]
    for row in range(COUNT):
        each = [instant_of(seen, row, row / 15).views for seen in (WALKS, SQUATS)]
        for place, own in enumerate(order):
            people = []
            for number, who in enumerate(own[: 1 + both[row]]):
                view = each[who][place]
                assert view is not None
                people.append(msgspec.structs.replace(view.people[0], track=number))
            first = each[0][place]
            assert first is not None
            found[place].append(msgspec.structs.replace(first, people=tuple(people)))
    return found


def is_of(track: JointTrack, seen: Sightings, place: int) -> bool:
    return bool(np.allclose(track.joints_px, seen.tracks[place].joints_px[:COUNT]))


@pytest.mark.slow
@pytest.mark.parametrize("order", [((0, 1), (1, 0), (0, 1)), ((1, 0), (0, 1), (0, 1))])
def test_the_person_is_the_same_in_all_views_whoever_each_follows(
    monkeypatch: pytest.MonkeyPatch, order: tuple[tuple[int, int], ...]
) -> None:
    """These made-up landmarks err more than those of pictures: one person's tracks miss by 0.40 at
    most, those of two by 0.96 at least."""
    monkeypatch.setattr(one_of_several, "ALIKE", 0.5)
    found = person_tracks(views_of(order))
    whose = {
        who
        for who, seen in enumerate((WALKS, SQUATS))
        if all(is_of(track, seen, place) for place, track in enumerate(found))
    }
    assert len(whose) == 1


def miss_where(squatting: float, walking: float, else_: float) -> Callable[..., float]:
    """Misses of tracks of one person or the other, and of two."""

    def miss(one: JointTrack, other: JointTrack) -> float:
        squats = [any(is_of(track, SQUATS, place) for place in range(3)) for track in (one, other)]
        return {0: walking, 2: squatting}.get(sum(squats), else_)

    return miss


def test_who_fits_best_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(one_of_several, "_miss", miss_where(0.1, 0.3, 0.2))
    found = person_tracks(views_of(((0, 1), (1, 0), (0, 1))))
    assert [is_of(track, SQUATS, place) for place, track in enumerate(found)] == [True] * 3


@pytest.mark.parametrize(("miss", "is_followed"), [(ALIKE - 0.01, False), (ALIKE + 0.01, True)])
def test_where_no_tracks_are_surely_one_persons_it_is_who_each_view_follows(
    monkeypatch: pytest.MonkeyPatch, miss: float, is_followed: bool
) -> None:
    monkeypatch.setattr(one_of_several, "_miss", miss_where(miss, 0.9, 0.9))
    first, second = person_tracks(views_of(((0, 1), (1, 0))))
    assert is_of(first, SQUATS, 0) == (not is_followed)
    assert is_of(second, SQUATS, 1)


def test_views_of_one_person_are_as_each_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    """A second one who is there for a moment is nothing to tell apart, and nothing is compared."""
    monkeypatch.setattr(one_of_several, "_own_tracks", None)
    few = [row < 0.05 * COUNT for row in range(COUNT)]
    for views in (views_of(((0,), (1,))), views_of(((0, 1), (1, 0)), few)):
        for track, own in zip(person_tracks(views), views, strict=True):
            for part, told in zip(track, track_of(own), strict=True):
                np.testing.assert_array_equal(part, told)


def test_a_view_without_any_landmarks_leaves_all_as_they_are() -> None:
    views = views_of(((0, 1), (1, 0)))
    bare = [
        msgspec.structs.replace(
            view,
            people=tuple(msgspec.structs.replace(one, landmarks=None) for one in view.people),
        )
        for view in views[1]
    ]
    first, second = person_tracks([views[0], bare])
    assert is_of(first, WALKS, 0)
    assert not second.confidence.any()


def test_short_tracks_are_not_compared() -> None:
    few = [row % 4 == 0 and row < 0.9 * COUNT for row in range(COUNT)]
    assert sorted(one_of_several._own_tracks(views_of(((0, 1),), few)[0])) == [0]
    assert sorted(one_of_several._own_tracks(views_of(((0, 1),))[0])) == [0, 1]
