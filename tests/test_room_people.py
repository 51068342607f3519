"""Who is in pictures of which nothing else is known, held against a rendered room."""

from test_own_landmarks import acted

from viewer.room.room_people import looked_at


def test_somebody_is_told_from_an_empty_room() -> None:
    shot, _, _, empty = acted()
    there, gone = looked_at([shot.frame1, empty])
    assert (there.is_somebody, gone.is_somebody) == (True, False)
    assert not gone.region(shot.mask1.shape, 0.1).any()
    assert (there.region(shot.mask1.shape, 0.1)[shot.mask1] > 0).mean() > 0.95
