"""Key frames, and the poses between them (thesis 3.1.5, 4.1; T23)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from animator.skeleton.bones import Motion, Skeleton, joints_of
from common.body.body import Vector

Frames = NDArray[np.int64]

APART: Final = 6
"""Frames per key frame: the thesis took 33 of 200 and 17 of 82, one in 5 or 6."""


def key_frames(clarity: Vector, apart: int = APART) -> Frames:
    """The key frames: of every stretch the frame that hides least, and both ends.

    Args:
        clarity: (n,) visible share of the body in each frame, in [0, 1]; NaN: no pose.
        apart: Length of a stretch, frames: short enough that a movement of two stretches has a key
            frame.

    Returns:
        Indices into `clarity`, in order; empty where there is no pose at all.
    """
    posed = np.flatnonzero(np.isfinite(clarity))
    if not len(posed):
        return posed
    clearest = [
        stretch[np.argmax(clarity[stretch])]
        for start in range(posed[0], posed[-1] + 1, apart)
        if len(stretch := posed[(posed >= start) & (posed < start + apart)])
    ]
    return np.unique([posed[0], *clearest, posed[-1]])


def kept_within(skeleton: Skeleton, motion: Motion, keys: Frames, most_m: float) -> Frames:
    """The key frames and as many more as keep what is interpolated near to the motion.

    Of each stretch in which a joint is farther off the frame of the farthest is added, until there
    is none.

    Args:
        skeleton: The body.
        motion: (n,) its motion, a row a frame.
        keys: Rows of it, at least one, in order.
        most_m: How far a joint may be off, metres.

    Source: the refinement of Douglas and Peucker 1973.
    """
    frames, true_m = np.arange(len(motion.root_m)), joints_of(skeleton, motion)
    while True:
        drawn_m = joints_of(skeleton, between(keys, at(motion, keys), frames))
        off_m = np.linalg.norm(drawn_m - true_m, axis=2).max(axis=1)
        off_m[keys] = 0.0
        stretches = np.split(frames, keys)
        worst = [rows[np.argmax(off_m[rows])] for rows in stretches if len(rows)]
        added = [row for row in worst if off_m[row] > most_m]
        if not added:
            return keys
        keys = np.union1d(keys, added)


def between(keys: Frames | Vector, motion: Motion, frames: Frames) -> Motion:
    """The motion at `frames`: interpolated between the key frames, the shorter way round.

    Args:
        keys: (k,) increasing frames, at least one; a key may lie between two of them.
        motion: At the key frames: k rows.
        frames: Any; before the first key and after the last the pose is held.
    """
    root_m = np.column_stack([np.interp(frames, keys, column) for column in motion.root_m.T])
    held = np.clip(frames, keys[0], keys[-1])
    return Motion(root_m, tuple(_turned(keys, turns, held) for turns in motion.turns))


def at(motion: Motion, rows: Frames) -> Motion:
    """Some rows of a motion."""
    return Motion(motion.root_m[rows], tuple(turns[rows] for turns in motion.turns))


def _turned(keys: Frames | Vector, turns: Rotation, frames: Frames) -> Rotation:
    if len(keys) == 1:
        return turns[np.zeros(len(frames), np.int64)]
    return Slerp(keys, turns)(frames)
