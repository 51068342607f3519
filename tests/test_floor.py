"""The floor of a scene."""

import numpy as np
import pytest

from synth.picture.random_rig import rig_around
from synth.picture.render import room_of
from synth.scene.floor import FURNITURE_M, NEAREST_M, ground, inside


@pytest.mark.parametrize("cameras", [1, 2, 5])
def test_places_are_in_all_pictures_far_enough_from_cameras_and_walls(cameras: int) -> None:
    rig = rig_around((64, 48), cameras, 2)
    place = ground(rig, room_of(2, rig))
    assert len(place.places_m) > 50
    for camera in rig.cameras:
        R, t = np.array(camera.R), np.array(camera.t)
        for aside in (-0.4, 0.4):
            points = np.insert(place.places_m, 1, 1.0, axis=1) @ R.T + t + [aside, 0.0, 0.0]
            column = camera.K[0][0] * points[:, 0] / points[:, 2] + camera.K[0][2]
            assert ((column >= -1e-6) & (column <= 64 + 1e-6)).all()
    gaps = np.linalg.norm(place.places_m[:, None] - place.eyes_m, axis=2)
    assert gaps.min() >= NEAREST_M
    low, high = place.room.low[[0, 2]], place.room.high[[0, 2]]
    assert (place.places_m - low).min() >= FURNITURE_M - 1e-9
    assert (high - place.places_m).min() >= FURNITURE_M - 1e-9
    assert {*map(tuple, place.opening_m)} <= {*map(tuple, place.places_m)}


def test_inside_is_between_the_walls_or_a_little_behind_them() -> None:
    rig = rig_around((64, 48), 2, 2)
    room = room_of(2, rig)
    wall = np.array([[room.high[0] + 0.3, 0.0], [0.0, room.low[2] - 0.3], [0.0, 0.0]])
    assert inside(room, wall).tolist() == [False, False, True]
    assert inside(room, wall, 0.4).tolist() == [True, True, True]
