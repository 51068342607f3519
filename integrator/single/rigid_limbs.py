"""Limbs in a single view, adjusted to their lengths: mainly in depth, the least certain
direction (3.1.5)."""

from itertools import chain, pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector

DEPTH_TIMES: Final = 2.0
"""Ratio of a joint's uncertainty along the line of sight to that across it. Of 1, 2 and 4 this
one has the least error in the world on two performers; in the picture all improve
(docs/measurements.md)."""
HALVINGS: Final = 40
LEAST: Final = 1e-6
"""Share of a rigid limb that is added to a limb whose ends may coincide."""
MOST: Final = 1e3
"""Largest length of a limb, over its known length."""
_LIMBS: Final = tuple(
    tuple(JOINT_NAMES.index(f"{side}_{joint}") for joint in limb)
    for limb in (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle"))
    for side in "lr"
)


def with_lengths(
    joints_m: NDArray[np.float64], rigid_m: NDArray[np.float64], centre_m: Vector
) -> NDArray[np.float64]:
    """The joints, (n, 15, 3), of a body with rigid arms and legs that stay near the observed ones.

    Args:
        joints_m: (n, 15, 3) observed.
        rigid_m: (n, 15, 3) of the body whose limbs have their lengths; its trunk is kept.
        centre_m: (3,) the camera's place.
    """
    found = rigid_m.copy()
    away = joints_m - centre_m
    sights = away / np.linalg.norm(away, axis=2, keepdims=True)
    for near, far in chain.from_iterable(map(pairwise, _LIMBS)):
        limbs_m = rigid_m[:, far] - rigid_m[:, near]
        long_m = np.linalg.norm(limbs_m, axis=1, keepdims=True)
        limbs_m = joints_m[:, far] - found[:, near] + LEAST * limbs_m
        found[:, far] = found[:, near] + _of_length(limbs_m, long_m, sights[:, far])
    return found


def _of_length(
    limbs_m: NDArray[np.float64], long_m: NDArray[np.float64], sights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The most probable limbs (n, 3) of known lengths, given the observed ones.

    For a joint with variance v and a Lagrange multiplier k, the observed limb shrinks by 1 / (1 + k
    v); the length falls with k, which is found by bisection.

    Args:
        limbs_m: (n, 3)
        long_m: (n, 1)
        sights: (n, 3) directions to the far joints, unit length.
    """
    depth_m = (limbs_m * sights).sum(axis=1, keepdims=True) * sights
    across_m, variance = limbs_m - depth_m, DEPTH_TIMES**2
    low, high = np.full_like(long_m, -1.0 / variance), np.full_like(long_m, MOST)
    for _ in range(HALVINGS):
        k = 0.5 * (low + high)
        found_m = across_m / (1.0 + k) + depth_m / (1.0 + k * variance)
        longer = np.linalg.norm(found_m, axis=1, keepdims=True) > long_m
        low, high = np.where(longer, k, low), np.where(longer, high, k)
    now_m = np.linalg.norm(found_m, axis=1, keepdims=True)
    return np.asarray(found_m * (long_m / np.maximum(now_m, 1e-9)))
