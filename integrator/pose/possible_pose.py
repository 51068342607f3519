"""Poses that no body takes: limbs beyond their lengths, or all of it far above the floor."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from calibration.tracks import person_prior as prior

LONGEST: Final = 1.75
"""Length of a segment, over its usual share of the stature, above which no body has it: it is 1.4
at most in all frames of four performers, whose arms are the worst (docs/measurements.md)."""
JUMP_M: Final = 0.75
"""Height of the lowest joint above the floor, metres, that no jump reaches: it would need 0.78 s
in the air, by h = g t^2 / 8."""

_BREADTHS: Final = [prior.LENGTHS.index(name) for name in ("shoulders", "hips")]
_LIMBS: Final = np.flatnonzero(~np.isin(prior.LENGTH_OF, _BREADTHS))


def has_possible_limbs(joints_m: NDArray[np.float64], stature_m: float) -> bool:
    """Whether the segments of a body (15, 3) have lengths that a person of that stature may have;
    the breadths of shoulders and hips are not compared."""
    near, far = prior.ENDS[_LIMBS].T
    long_m = np.linalg.norm(joints_m[far] - joints_m[near], axis=1)
    return bool((long_m <= LONGEST * prior.SHARES[prior.LENGTH_OF[_LIMBS]] * stature_m).all())


def is_within_a_jump(joints_m: NDArray[np.float64]) -> bool:
    """Whether the lowest joint of a body (15, 3) is not higher above the floor than a jump."""
    return bool(joints_m[:, 1].min() <= JUMP_M)
