"""Made-up rooms, seen by cameras that stand anywhere."""

import numpy as np
import pytest

from synth.picture.random_rig import random_rig, rig_around
from synth.picture.synth_room import furnished
from synth.things.furnishing import furniture, walls_of, walls_seen


@pytest.mark.slow
@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("seed", [2, 32])
def test_a_room_is_lit_as_rooms_are_wherever_its_cameras_stand(seed: int) -> None:
    """Of seed 32 one camera stands higher than most ceilings: it saw light without end."""
    rig = random_rig(np.random.default_rng([seed, 81]), 0.4, (2.3, 5.6))
    for picture in furnished(seed, rig).pictures:
        assert np.isfinite(picture).all()
        assert picture.std() > 5.0
        assert picture.mean() < 250.0


@pytest.mark.parametrize(("cameras", "furnished_walls"), [(1, 2), (2, 2), (3, 4), (8, 4)])
def test_things_stand_along_every_wall_that_is_seen_behind_a_person(
    cameras: int, furnished_walls: int
) -> None:
    """Each thing touches a wall from inside."""
    rng = np.random.default_rng(6)
    (room,) = walls_of(rng, rig_around((80, 60), cameras, 6))
    things = furniture(rng, walls_seen(room, cameras))
    touched = set()
    for thing in things:
        sides = [(axis, 0) for axis in (0, 2) if thing.low[axis] == room.low[axis]]
        sides += [(axis, 1) for axis in (0, 2) if thing.high[axis] == room.high[axis]]
        assert sides
        touched |= set(sides)
    assert len(touched) == furnished_walls
