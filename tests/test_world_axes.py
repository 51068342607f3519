"""Where the world of a rig begins."""

import math

import numpy as np
import pytest

from calibration.person.world_axes import origin_of
from calibration.tracks.rig_guess import Pinhole, rotation


def pair(second_at: tuple[float, float], yaw_deg: float) -> tuple[Pinhole, Pinhole]:
    at = np.array([second_at[0], 1.2, second_at[1]])
    first = Pinhole(200.0, rotation(0.0, -0.1, 0.0), np.array([0.0, 1.0, 0.0]))
    return first, Pinhole(200.0, rotation(math.radians(yaw_deg), 0.0, 0.05), at)


def test_the_world_begins_where_the_lines_of_sight_cross_whoever_stands_there() -> None:
    for person_m in ([0.0, 1.0, -4.0], [0.6, 1.0, -4.8]):
        found = origin_of(pair((-4.5, -4.2), -90.0), np.array(person_m))
        assert found == pytest.approx([0.0, 0.0, -4.2])


@pytest.mark.parametrize(
    "cameras",
    [pair((1.0, 0.0), 2.0), pair((-4.5, -9.0), -90.0), pair((-4.5, -4.2), 90.0)],
    ids=["nearly parallel", "far from the person", "behind a camera"],
)
def test_lines_that_cross_nowhere_near_leave_it_under_the_person(
    cameras: tuple[Pinhole, Pinhole],
) -> None:
    assert origin_of(cameras, np.array([0.3, 1.0, -4.0])) == pytest.approx([0.3, 0.0, -4.0])
