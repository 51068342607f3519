"""A body of fixed bones fitted to joints that were tracked separately."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from animator.skeleton.bones import Joints, Skeleton
from common.body.body import Vector
from common.body.extremities import ALL_JOINT_NAMES

Floats = NDArray[np.float64]

ROUNDS: Final = 5
"""Rounds of the fit: for joints that are 1 cm off, bones are within a hundredth of a millimetre
of theirs."""
AT_ONCE: Final = 4096
"""Number of rows that are fitted together: a long video would exceed the memory."""
NO_BONE: Final = 1e-9
"""Added where both ends of a bone coincide and it has no direction."""
_AT: Final = {name: i for i, name in enumerate(ALL_JOINT_NAMES)}


def fitted(skeleton: Skeleton, joints_m: Joints, weights: Floats) -> Joints:
    """The skeleton's joints nearest to these, by weighted least squares.

    Where a bone is too short for its tracked ends, both ends move, and the bones beyond. Aiming the
    bones one after the other would put the whole difference at the farther end.

    Args:
        skeleton: The run's skeleton.
        joints_m: (n, 15 or 22, 3) without NaN; the pelvis between the hips.
        weights: Likewise, the resistance of each to motion along each axis; the pelvis' do not
            count.

    Returns:
        (n, 15 or 22, 3); nose and heels, at which no bone ends, are not changed.

    Source: Mueller et al. 2007, Position based dynamics, with all constraints solved at once.
    """
    names = ["r_hip", *(bone.ends for bone in skeleton.bones)]
    free, bones, found = [_AT[name] for name in names], _bones(skeleton, names), joints_m.copy()
    for first in range(0, len(joints_m), AT_ONCE):
        rows = slice(first, first + AT_ONCE)
        found[rows, free] = _places(*bones, joints_m[rows, free], 1.0 / weights[rows, free])
    found[:, _AT["pelvis"]] = (found[:, _AT["l_hip"]] + found[:, _AT["r_hip"]]) / 2
    return found


def _places(ends: Floats, lengths_m: Vector, tracked: Floats, gives: Floats) -> Floats:
    """Places of joints (n, joints, 3) that yield by the given amounts along each axis."""
    shares = [(ends * gives[:, None, :, axis]) @ ends.T for axis in range(3)]
    wanted, places = ends @ tracked, tracked
    for _ in range(ROUNDS):
        along = ends @ places
        along = along / np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-9)
        turned = along.transpose(2, 0, 1)
        normal = np.zeros_like(shares[0])
        for share, part in zip(shares, turned, strict=True):
            normal += share * part[:, :, None] * part[:, None, :]
        normal += NO_BONE * np.eye(len(ends))
        lack_m = (along * wanted).sum(axis=2) - lengths_m
        pull = np.linalg.solve(normal, lack_m[..., None]) * along
        places = tracked - gives * (ends.T @ pull)
    return places


def _bones(skeleton: Skeleton, names: list[str]) -> tuple[Floats, Vector]:
    """Incidence of joints and bones, (bones, joints), 1 at a bone's end and -1 at its start, the
    pelvis half of either hip; and the bones' lengths, the first from hip to hip."""
    ends = np.array([_at(names, bone.ends) - _at(names, bone.starts) for bone in skeleton.bones])
    lengths_m = np.linalg.norm(skeleton.tips_m, axis=1)
    ends[0], lengths_m[0] = _at(names, "l_hip") - _at(names, "r_hip"), 2 * lengths_m[0]
    return ends, lengths_m


def _at(names: list[str], joint: str) -> Vector:
    parts = ("l_hip", "r_hip") if joint == "pelvis" else (joint,)
    return np.array([float(name in parts) / len(parts) for name in names])
