"""Turns of a skeleton's bones that follow a run's joints."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from animator.skeleton.bones import (
    AT,
    BONES,
    OF_JOINTS,
    Joints,
    Motion,
    Skeleton,
    between_m,
    offset_m,
    spine_axes,
)
from animator.skeleton.limb_twist import AXES, HINGES, Before, bends_of, limb_twists, twist_axes
from animator.turns import arc_axes, axes_of
from common.body.body import Vector

Floats = NDArray[np.float64]


class _Generation(NamedTuple):
    """Bones at the same depth in the hierarchy, which are turned together."""

    bones: list[int]
    """Indices in BONES."""
    parents: list[int]
    ends: list[int]
    """Indices in ALL_JOINT_NAMES of the landmarks that they are aimed at."""
    hinges: list[int]
    """Indices in HINGES of the upper limbs among them."""
    uppers: list[int]
    """Their indices in BONES."""
    lower_ends: list[int]
    """Indices of the landmarks that the lower limbs are aimed at."""


def _generation(bones: list[int]) -> _Generation:
    names = list(HINGES)
    uppers = [i for i in bones if BONES[i].name in names]
    return _Generation(
        bones,
        [BONES[i].parent for i in bones],
        [AT[BONES[i].ends] for i in bones],
        [names.index(BONES[i].name) for i in uppers],
        uppers,
        [AT[bone.ends] for i in uppers for bone in BONES if bone.parent == i],
    )


_DEPTHS: Final = [0]
for _bone in BONES[1:]:
    _DEPTHS.append(_DEPTHS[_bone.parent] + 1)
_GENERATIONS: Final = {
    count: tuple(
        _generation(bones)
        for depth in range(1, 1 + max(_DEPTHS[:count]))
        if (bones := [i for i in range(2, count) if _DEPTHS[i] == depth])
    )
    for count in OF_JOINTS.values()
}
"""The levels of a skeleton with that many bones, after hips and spine."""


class Turned(NamedTuple):
    """Turns of a skeleton's bones in n frames."""

    axes: Floats
    """(bones, n, 3, 3) turns as matrices, each in its parent's axes."""
    twists: Vector
    """(4, n) twists of the upper limbs, radians, in the order of HINGES."""


def motion_of(skeleton: Skeleton, joints_m: Joints, time_s: Vector) -> Motion:
    """The turns of a skeleton that follow joints without NaN at (n,) increasing times."""
    axes = turned_axes(skeleton, joints_m, time_s).axes
    turns = tuple(Rotation.from_matrix(own, assume_valid=True) for own in axes)
    return Motion(joints_m[:, AT["pelvis"]], turns)


def turned_axes(
    skeleton: Skeleton, joints_m: Joints, time_s: Vector, before: Before | None = None
) -> Turned:
    """The turns of a skeleton's bones for given joints.

    Every bone is aimed at its landmark from the end of the bone before, so that a deviating length
    shifts one landmark and not the rest of the limb. Upper arms and thighs are twisted so that the
    lower limb bends about its hinge's axis (`limb_twists`).

    Args:
        skeleton: The body.
        joints_m: Without NaN.
        time_s: (n,) capture times.
        before: (4,) twists of the frame before the first; None: there is none.
    """
    local = np.empty((len(skeleton.bones), len(joints_m), 3, 3))
    world, origins_m = np.empty_like(local), np.empty(local.shape[:-1])
    twists = np.empty((len(HINGES), len(joints_m)))
    hips, spine = _hips_axes(joints_m), spine_axes(joints_m)
    world[:2], local[:2] = (hips, spine), (hips, hips.swapaxes(-1, -2) @ spine)
    origins_m[:2] = joints_m[:, AT["pelvis"]]
    offsets_m = np.array([offset_m(skeleton, i) for i in range(len(local))])
    for bones, parents, ends, hinges, uppers, lower_ends in _GENERATIONS[len(local)]:
        above = world[parents]
        origins_m[bones] = origins_m[parents] + _applied(above, offsets_m[bones, None])
        aims = _aims(joints_m, ends, origins_m[bones], above)
        local[bones] = arc_axes(skeleton.tips_m[bones, None], aims)
        world[bones] = above @ local[bones]
        if uppers:
            middles_m = origins_m[uppers] + _applied(world[uppers], skeleton.tips_m[uppers, None])
            bends = bends_of(AXES[hinges], _aims(joints_m, lower_ends, middles_m, world[uppers]))
            held = None if before is None else before._replace(twists=before.twists[hinges])
            twists[hinges] = limb_twists(bends, time_s, held)
            twist = twist_axes(AXES[hinges], twists[hinges])
            local[uppers], world[uppers] = local[uppers] @ twist, world[uppers] @ twist
    return Turned(local, twists)


def _hips_axes(joints_m: Joints) -> Floats:
    up = between_m(joints_m, "pelvis", "neck")
    return axes_of(up, between_m(joints_m, "r_hip", "l_hip"), keep="across")


def _aims(joints_m: Joints, ends: list[int], origins_m: Floats, axes: Floats) -> Floats:
    """From places (bones, n, 3) to landmarks, in the axes (bones, n, 3, 3)."""
    return _applied(axes.swapaxes(-1, -2), joints_m[:, ends].swapaxes(0, 1) - origins_m)


def _applied(axes: Floats, along: Floats) -> Floats:
    """Directions (..., 3) turned by matrices (..., 3, 3)."""
    found: Floats = (axes @ along[..., None])[..., 0]
    return found
