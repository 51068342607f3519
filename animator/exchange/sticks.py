"""A stick figure for a skeleton: a cylinder along each bone, bound to it alone."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.skeleton.bones import Skeleton, rest_origins_m
from animator.solids import unit_cylinder
from animator.turns import arc

THICKNESS: Final = 0.12
"""Radius of a stick as a share of its length."""
COLOUR: Final = (0.55, 0.6, 0.65)
"""Red, green, blue of all sticks."""
_UP: Final = np.array([0.0, 1.0, 0.0])


class Sticks(NamedTuple):
    """The figure at rest: a cylinder along each bone."""

    places_m: NDArray[np.float32]
    """(n, 3)"""
    faces: NDArray[np.uint32]
    """(m, 3)"""
    bones: NDArray[np.uint16]
    """(n,) index of each point's bone."""


def sticks_of(skeleton: Skeleton) -> Sticks:
    """The figure of a body at rest."""
    unit, origins_m = unit_cylinder(), rest_origins_m(skeleton)
    places, faces, bones = [], [], []
    for i, tip_m in enumerate(skeleton.tips_m):
        length_m = max(float(np.linalg.norm(tip_m)), 1e-3)
        scaled = unit.vertices * (THICKNESS * length_m, length_m, THICKNESS * length_m)
        turned = arc(_UP, tip_m[None]).apply(scaled)
        faces.append(unit.faces + i * len(unit.vertices))
        places.append(origins_m[i] + turned)
        bones.append(np.full(len(turned), i))
    return Sticks(
        np.concatenate(places).astype(np.float32),
        np.concatenate(faces).astype(np.uint32),
        np.concatenate(bones).astype(np.uint16),
    )
