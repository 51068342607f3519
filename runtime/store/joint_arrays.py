"""Joints and extremities of a run: separate in memory, concatenated on disk."""

from typing import Any, Final

import numpy as np

from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES
from common.npz_file import Arrays, Facts

_BEHIND: Final = {
    "joints_m": ("extremities_m", 1),
    "joints_px": ("extremities_px", 2),
    "confidence": ("extremities_confidence", 1),
}
"""Extremities' array that is appended to a joints' array, and the axis."""


def on_disk(arrays: Arrays) -> Facts:
    """The arrays of `poses.npz`: everything indexed by `joint_names` is in one array."""
    held = dict(arrays)
    if "extremities_m" not in held:
        return held
    for name, (further, axis) in _BEHIND.items():
        held[name] = np.concatenate([held[name], held.pop(further)], axis=axis)
    held["joint_names"] = np.array(ALL_JOINT_NAMES)
    return held


def all_joints_m(arrays: Arrays) -> Any:
    """Joints and extremities of a run, (n, 22, 3); joints alone, (n, 15, 3), where it has no
    more."""
    further = arrays.get("extremities_m")
    joints_m = arrays["joints_m"]
    return joints_m if further is None else np.concatenate([joints_m, further], axis=1)


def parted(held: Arrays) -> Arrays:
    """The arrays split again; unchanged where they are not by ALL_JOINT_NAMES."""
    names = tuple(str(name) for name in np.ravel(held.get("joint_names", ())))
    if names != ALL_JOINT_NAMES:
        return held
    arrays = dict(held)
    for name, (further, axis) in _BEHIND.items():
        array = np.asarray(held.get(name))
        if array.ndim <= axis or array.shape[axis] != len(ALL_JOINT_NAMES):
            return held
        arrays[name], arrays[further] = np.split(array, [len(JOINT_NAMES)], axis=axis)
    arrays["joint_names"] = np.array(JOINT_NAMES)
    return arrays
