"""Rigs of any number of cameras around a person."""

from itertools import combinations

import numpy as np
import pytest

from common.rig.camera import centre, project
from synth.picture.exposure import default_rig
from synth.picture.random_rig import MOST_CAMERAS, rig_around

SIZE = (320, 240)


def test_a_rig_of_two_is_the_default_one_of_every_seed() -> None:
    assert rig_around(SIZE, 2, 0) == rig_around(SIZE, 2, 7) == default_rig(*SIZE)


def test_a_rig_of_more_begins_with_the_cameras_of_fewer_and_its_seed_moves_the_further() -> None:
    most, other = (rig_around(SIZE, MOST_CAMERAS, seed).cameras for seed in (7, 8))
    assert [camera.name for camera in most] == [f"cam{n + 1}" for n in range(8)]
    for count in range(1, MOST_CAMERAS):
        assert rig_around(SIZE, count, 7).cameras == most[:count]
    assert not set(most[2:]) & set(other)


@pytest.mark.parametrize("seed", range(5))
def test_cameras_stand_apart_and_none_opposite_another(seed: int) -> None:
    """The angle between two of them at the body's middle: 0 or 180 degrees would show one view."""
    places = [centre(camera) for camera in rig_around(SIZE, MOST_CAMERAS, seed).cameras]
    ways = [(place - [0.0, 1.0, 0.0]) / np.linalg.norm(place - [0.0, 1.0, 0.0]) for place in places]
    for one, other in combinations(ways, 2):
        assert 20.0 < np.degrees(np.arccos(one @ other)) < 176.0
    between = [np.degrees(np.arccos(a @ b)) for a, b in combinations(ways[:4], 2)]
    assert min(between) > 45.0


@pytest.mark.parametrize("seed", range(5))
def test_all_cameras_see_a_whole_person_upright_in_the_middle_of_the_room(seed: int) -> None:
    for camera in rig_around(SIZE, MOST_CAMERAS, seed).cameras:
        foot, head = project(camera, np.array([[0.0, 0.0, 0.0], [0.0, 1.9, 0.0]]))
        assert 100 < foot[1] - head[1] < 200
        assert abs(foot[0] - head[0]) < 15
        for pixel in (foot, head):
            assert ((pixel > 0) & (pixel < SIZE)).all()
