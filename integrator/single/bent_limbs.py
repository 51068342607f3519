"""Forearms and shanks that bend as joints allow: their depth from one silhouette is a guess."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import LIMB_ENDS, LIMBS
from integrator.single import reflection
from integrator.single.sight import Sight, posed

LOWER: Final = [limb for limb, name in enumerate(LIMBS) if "lower" in name]
"""Indices in LIMBS."""
BEYOND_M: Final = 0.05
"""Displacement of a limb's end by joint limits, metres, beyond which the limb is mirrored in
depth, if its mirror image is within them."""


def bent(sight: Sight, joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """The joints (15, 3), with lower limbs mirrored in depth where only the mirror image is within
    limits.

    Args:
        sight: One view of the instant.
        joints_m: (15, 3) world.
    """
    for limb in LOWER:
        moved_m = _moved_m(sight, joints_m, limb)
        if moved_m > BEYOND_M:
            other_m = reflection.mirrored(sight.camera, joints_m, limb)
            if _moved_m(sight, other_m, limb) < moved_m:
                joints_m = other_m
    return joints_m


def _moved_m(sight: Sight, joints_m: NDArray[np.float64], limb: int) -> float:
    """Displacement of a limb's end by the limits."""
    end = LIMB_ENDS[limb, 1]
    return float(np.linalg.norm(posed(sight, joints_m)[1][end] - joints_m[end]))
