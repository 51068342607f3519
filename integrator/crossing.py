"""Which limb is whose after they crossed: one outline hardly tells left from right (T17)."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body import JOINT_NAMES

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
ROOTS: Final = [[_AT[f"{side}_{name}"] for side in "lr"] for name in ("hip", "shoulder")]
"""(2 pairs, 2 sides): what limbs hang on."""
TIPS: Final = [
    [[_AT[f"{side}_{name}"] for name in names] for side in "lr"]
    for names in (("knee", "ankle"), ("elbow", "wrist"))
]
"""(2 pairs, 2 sides, 2 joints)"""
SURELY: Final = 0.8
"""Limbs change sides where that leaves less than this share of what surprises, ..."""
LEAST_M: Final = 0.1
"""... and this much less, squared."""
CALM: Final = 0.5
"""Share of a limb's motion that is new in each frame."""


class Strides(NamedTuple):
    """How limbs hang and move: (2 pairs, 2 sides, 2 joints, 3) metres, and metres a frame."""

    hang_m: NDArray[np.float64]
    step_m: NDArray[np.float64]


def kept_apart(
    before: Strides | None, joints_m: NDArray[np.float64]
) -> tuple[Strides, NDArray[np.float64]]:
    """The body with legs and arms on the sides where their motion leads them.

    Of legs that pass each other each goes on as it went; a proposal from the outline alone may
    have them turn back instead, and one leg lead at every step.

    Args:
        before: Of the frame before; None at the first.
        joints_m: (15, 3) world.
    """
    hang_m = joints_m[TIPS] - joints_m[ROOTS][:, :, None]
    if before is None:
        return Strides(hang_m, np.zeros_like(hang_m)), joints_m
    due = before.hang_m + before.step_m
    for pair in range(len(hang_m)):
        kept, changed = (
            ((hang - due[pair]) ** 2).sum() for hang in (hang_m[pair], hang_m[pair][::-1])
        )
        if changed < SURELY * kept and kept - changed > LEAST_M**2:
            hang_m[pair] = hang_m[pair][::-1].copy()
    step_m = (1.0 - CALM) * before.step_m + CALM * (hang_m - before.hang_m)
    found = joints_m.copy()
    found[TIPS] = joints_m[ROOTS][:, :, None] + hang_m
    return Strides(hang_m, step_m), found
