"""Who is in pictures of which nothing else is known, held against a rendered room."""

import msgspec
import numpy as np
import pytest
from test_own_landmarks import acted

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.video.pictures import Image
from viewer.landmarks.own_landmarks import found_anywhere
from viewer.room import room_people
from viewer.room.room_people import Look, _place, are_sure, looked_at


def test_somebody_is_told_from_an_empty_room() -> None:
    shot, _, _, empty = acted()
    there, gone = looked_at([shot.frames[0], empty])
    assert (there.is_somebody, gone.is_somebody) == (True, False)
    assert not gone.region(shot.masks[0].shape, 0.1).any()
    assert (there.region(shot.masks[0].shape, 0.1)[shot.masks[0]] > 0).mean() > 0.95


def test_looks_that_are_hardly_sure_tell_no_body_from_the_room() -> None:
    shot, _, _, empty = acted()
    (look,) = looked_at([shot.frames[0]])
    doubtful = look._replace(
        landmarks=msgspec.structs.replace(look.landmarks, confidence=(0.2,) * len(JOINT_NAMES))
    )
    assert are_sure([look, look, doubtful])
    assert not are_sure([look, doubtful, doubtful])
    assert not are_sure(looked_at([empty]))


def test_whom_a_wide_look_misses_is_found_where_other_pictures_have_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shot, *_ = acted()
    missed = shot.frames[0].copy()
    monkeypatch.setattr(
        "viewer.room.room_people.found_anywhere",
        lambda picture: (found_anywhere(picture)[0], 0.9 if picture is missed else 0.0),
    )
    *_, found = looked_at([*[shot.frames[0]] * 3, missed])
    assert found.is_somebody


def landmarks(x: float, sure: float) -> Landmarks:
    """From (x, 10) to (x + 14, 80), in the order of the joints."""
    return Landmarks(tuple((x + n, 10.0 + 5.0 * n) for n in range(15)), (sure,) * 15)


def fakes(
    patch: pytest.MonkeyPatch, sures: list[float], nobodies: list[float], again: list[list[float]]
) -> list[tuple[int, float]]:
    """Looks at pictures by their number: at all of it, then between corners; what was asked."""
    asked: list[tuple[int, float]] = []

    def anywhere(picture: Image) -> tuple[Landmarks, float]:
        n = int(picture[0, 0, 0])
        return landmarks(10.0 * n, sures[n]), nobodies[n]

    def between(picture: Image, _corners: np.ndarray, margin: float) -> tuple[Landmarks, float]:
        n = int(picture[0, 0, 0])
        asked.append((n, margin))
        turn = 0 if margin == 0.2 else 1
        return landmarks(100.0 + 10.0 * n, 0.9), again[turn][n]

    patch.setattr(room_people, "found_anywhere", anywhere)
    patch.setattr(room_people, "found_between", between)
    return asked


PICTURES = [np.full((2, 2, 3), n, np.uint8) for n in range(4)]


def test_who_is_seen_in_two_pictures_alone_is_not_looked_for_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Somebody is there below 0.35 of nobody."""
    asked = fakes(monkeypatch, [0.5] * 4, [0.34, 0.35, 0.0, 0.9], [])
    looks = looked_at(PICTURES)
    assert [look.is_somebody for look in looks] == [True, False, True, False]
    assert asked == []
    assert looks[2].landmarks == landmarks(20.0, 0.5)


def test_who_is_seen_in_three_is_looked_for_again_widely_and_then_closely(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Once seen, somebody stays; whom no look shows is left as the first look had it."""
    again = [[0.9, 0.9, 0.9, 0.9], [0.9, 0.9, 0.9, 0.34]]
    asked = fakes(monkeypatch, [0.5] * 4, [0.0, 0.0, 0.0, 0.9], again)
    looks = looked_at(PICTURES)
    assert asked == [(n, margin) for margin in (0.2, 0.06) for n in range(4)]
    assert [look.is_somebody for look in looks] == [True] * 4
    assert looks[3].landmarks == landmarks(130.0, 0.9)
    again[1][3] = 0.35
    looks = looked_at(PICTURES)
    assert not looks[3].is_somebody
    assert looks[3].landmarks == landmarks(30.0, 0.5)


def test_looks_that_are_led_astray_together_leave_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fakes(monkeypatch, [0.5] * 4, [0.0] * 4, [[0.0] * 4] * 2)
    monkeypatch.setattr(room_people, "are_sure", lambda _: False)
    assert [look.landmarks for look in looked_at(PICTURES)] == [
        landmarks(10.0 * n, 0.5) for n in range(4)
    ]


@pytest.mark.parametrize(("sure", "are"), [(0.401, True), (0.399, False)])
def test_the_median_look_at_somebody_is_sure_or_not(sure: float, are: bool) -> None:
    looks = [Look(landmarks(0.0, value), True) for value in (0.1, sure, 0.9)]
    looks.append(Look(landmarks(0.0, 0.9), False))
    assert are_sure(looks) == are
    assert not are_sure(looks[3:])


def test_people_stay_between_the_corners_that_most_of_the_surer_half_have() -> None:
    """By hand: of six the surer half stand at 20, 30 and 90; a fifth on either side is left out."""
    shown = [
        landmarks(x, sure)
        for x, sure in ((0.0, 0.1), (20.0, 0.9), (30.0, 0.8), (500.0, 0.2), (90.0, 0.7), (7.0, 0.3))
    ]
    low_x, high_x = 20.0 + 0.4 * 10.0, 44.0 + 0.6 * 60.0
    assert _place(shown) == pytest.approx(np.array([[low_x, 10.0], [high_x, 80.0]]))
