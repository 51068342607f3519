"""The world's origin and axes for a rig without marks."""

from typing import Final

import numpy as np

from calibration.tracks.rig_guess import Pinhole, pinholes, rig_of
from common.body.body import Vector
from common.rig.camera import Rig

NEAR_M: Final = 1.5
"""Distance from the person, metres, beyond which the crossing of the lines of sight is
meaningless."""
PARALLEL: Final = 0.1
"""Sine of the angle between lines of sight below which their crossing is uncertain."""


def published_rig(guess: Vector, size_px: tuple[int, int], person_m: Vector) -> Rig:
    """The rig of a guess in its own world: x to the right in camera 1, y up from the floor, z
    towards camera 1, and the origin on the floor where both lines of sight cross.

    The paper's rig is defined so (C1), and every clip of one rig then has the same world. Where the
    lines cross far from the person, or nowhere, the origin is under the person.

    Args:
        guess: A vector of `rig_guess.py`: its world has these axes already.
        size_px: Width and height of the pictures.
        person_m: First place of the person, (3,) in the world of the guess.
    """
    return rig_of(pinholes(guess), size_px, origin_of(pinholes(guess), person_m))


def origin_of(cameras: tuple[Pinhole, Pinhole], person_m: Vector) -> Vector:
    """(3,) on the floor, in the world of the cameras."""
    under = person_m * [1.0, 0.0, 1.0]
    sights = np.stack([camera.R[2, [0, 2]] for camera in cameras], axis=1)
    sights /= np.maximum(np.linalg.norm(sights, axis=0), 1e-9)
    if abs(np.linalg.det(sights)) < PARALLEL:
        return under
    starts = [camera.centre_m[[0, 2]] for camera in cameras]
    far_1, minus_far_2 = np.linalg.solve(sights, starts[1] - starts[0])
    x, z = starts[0] + far_1 * sights[:, 0]
    crossing = np.array([x, 0.0, z])
    near = np.linalg.norm(crossing - under) <= NEAR_M
    return crossing if near and far_1 > 0 and minus_far_2 < 0 else under
