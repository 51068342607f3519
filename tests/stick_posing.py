"""What the tests of the single view share: stick bodies drawn and posed."""

from typing import Any

import numpy as np

from common.body.body import LIMBS, Vector
from common.body.stick_body import ADULT, ANGLE, BREADTH, RATIO, Stickman, standing
from common.raster.similarity import Mask
from common.raster.stick_raster import draw_stick

SIZE = (320, 240)
STATURE_PX = 160.0


def stick_pose(turned_deg: dict[str, float], ratios: dict[str, float] | None = None) -> Vector:
    """A standing stick body with some limbs turned and shortened."""
    pose = standing(160.0, 130.0, STATURE_PX)
    for name, angle_deg in turned_deg.items():
        pose[ANGLE + LIMBS.index(name)] = angle_deg
    for name, ratio in (ratios or {}).items():
        pose[RATIO + LIMBS.index(name)] = ratio
    return pose


def drawn(pose: Vector, man: Stickman = ADULT) -> Mask:
    """Its silhouette."""
    return draw_stick(man, pose, SIZE)


def in_profile(pose: Vector) -> Vector:
    """The same, seen from the side."""
    pose = pose.copy()
    pose[BREADTH] = 0.1
    return pose


def larger(mask: Mask, times: int) -> Mask:
    """Every pixel as a block of them."""
    block: Any = np.ones((times, times), np.bool_)
    return np.asarray(np.kron(mask, block), np.bool_)
