"""Limbs keep their lengths: joints found separately are pulled to where they do."""

import math
from typing import Final

import numpy as np

from common.body.body import Floats, Vector
from common.compiled import compiled
from integrator.proposal.network_weights import JOINTS

SPRING_M: Final = 0.02
"""Standard deviation of a limb's length about its remembered one."""
LEARNT: Final = 0.05
"""Weight of one instant in the remembered lengths."""
ROUNDS: Final = 2

_PAIRS: Final = (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
ENDS: Final = np.array(
    [
        *([JOINTS.index(f"{side}_{end}") for end in pair] for pair in _PAIRS for side in "lr"),
        [JOINTS.index("l_shoulder"), JOINTS.index("r_shoulder")],
        [JOINTS.index("l_hip"), JOINTS.index("r_hip")],
    ]
)
"""(10, 2) the joints at both ends of springs: limbs, left and right in turn, and two girdles."""
_LIMBS: Final = 2 * len(_PAIRS)
USUAL: Final = np.array([0.16, 0.16, 0.145, 0.145, 0.25, 0.25, 0.245, 0.245, 0.205, 0.12])
"""(10,) lengths in statures, of adults."""
UNLIKE: Final = 1.3
"""Largest ratio of a length to the adult one, and its inverse the smallest. Lengths are learnt
from joints that were pulled to learnt lengths: without bounds, where one camera gives no depth,
a long limb grew further within minutes."""


def lengths_m(before: Vector | None, joints_m: Vector, stature_m: float) -> Vector:
    """The remembered lengths of the springs, (10,): both sides have the same.

    Args:
        before: The lengths at the instant before; None at the first.
        joints_m: (12, 3)
        stature_m: The person's stature.
    """
    found = np.linalg.norm(joints_m[ENDS[:, 0]] - joints_m[ENDS[:, 1]], axis=1)
    found[:_LIMBS] = np.repeat(found[:_LIMBS].reshape(-1, 2).mean(axis=1), 2)
    learnt = found if before is None else before + LEARNT * (found - before)
    usual_m = stature_m * USUAL
    return np.clip(learnt, usual_m / UNLIKE, usual_m * UNLIKE)


@compiled
def sprung(joints_m: Floats, precisions: Floats, lengths: Vector) -> Floats:
    """The most probable joints (n, 3), given the distances between them.

    Args:
        joints_m: Each at its own most probable place.
        precisions: (n, 6) xx, xy, xz, yy, yz, zz of their inverse covariances, 1 / m^2.
        lengths: (springs,) metres.
    """
    n = len(joints_m)
    found = joints_m.copy()
    stiff = 1.0 / (SPRING_M * SPRING_M)
    for _ in range(ROUNDS):
        normal, right = np.zeros((3 * n, 3 * n)), np.zeros(3 * n)
        for joint in range(n):
            k = 0
            for i in range(3):
                for j in range(i, 3):
                    a, b = 3 * joint + i, 3 * joint + j
                    tight = precisions[joint, k]
                    normal[a, b] = normal[b, a] = tight
                    right[a] -= tight * (found[joint, j] - joints_m[joint, j])
                    if i != j:
                        right[b] -= tight * (found[joint, i] - joints_m[joint, i])
                    k += 1
        for spring in range(len(ENDS)):
            _pull(ENDS[spring, 0], ENDS[spring, 1], lengths[spring], stiff, found, normal, right)
        found += np.linalg.solve(normal, right).reshape(n, 3)
    return found


@compiled
def _pull(
    near: int,
    far: int,
    length: float,
    stiff: float,
    joints_m: Floats,
    normal: Floats,
    right: Vector,
) -> None:
    """One spring's contribution to the normal equations."""
    x, y, z = (
        joints_m[near, 0] - joints_m[far, 0],
        joints_m[near, 1] - joints_m[far, 1],
        joints_m[near, 2] - joints_m[far, 2],
    )
    long = math.sqrt(x * x + y * y + z * z) + 1e-9
    axis = (x / long, y / long, z / long)
    over = long - length
    for i in range(3):
        right[3 * near + i] -= stiff * over * axis[i]
        right[3 * far + i] += stiff * over * axis[i]
        for j in range(3):
            pull = stiff * axis[i] * axis[j]
            normal[3 * near + i, 3 * near + j] += pull
            normal[3 * far + i, 3 * far + j] += pull
            normal[3 * near + i, 3 * far + j] -= pull
            normal[3 * far + i, 3 * near + j] -= pull
