"""Who is in pictures of which nothing else is known, held against a rendered room."""

import msgspec
import pytest
from test_own_landmarks import acted

from common.body.body import JOINT_NAMES
from viewer.landmarks.own_landmarks import found_anywhere
from viewer.room.room_people import are_sure, looked_at


def test_somebody_is_told_from_an_empty_room() -> None:
    shot, _, _, empty = acted()
    there, gone = looked_at([shot.frame1, empty])
    assert (there.is_somebody, gone.is_somebody) == (True, False)
    assert not gone.region(shot.mask1.shape, 0.1).any()
    assert (there.region(shot.mask1.shape, 0.1)[shot.mask1] > 0).mean() > 0.95


def test_looks_that_are_hardly_sure_tell_no_body_from_the_room() -> None:
    shot, _, _, empty = acted()
    (look,) = looked_at([shot.frame1])
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
    missed = shot.frame1.copy()
    monkeypatch.setattr(
        "viewer.room.room_people.found_anywhere",
        lambda picture: (found_anywhere(picture)[0], 0.9 if picture is missed else 0.0),
    )
    *_, found = looked_at([*[shot.frame1] * 3, missed])
    assert found.is_somebody
