"""Key frames, and the poses between them (thesis 3.1.5, 4.1; T23)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from animator.bones import Motion
from animator.turns import slerp
from common.body.body import Vector

Frames = NDArray[np.int64]

APART: Final = 6
"""Frames of one key frame: the thesis took 33 of 200 and 17 of 82, one in 5 or 6."""


def key_frames(clarity: Vector, apart: int = APART) -> Frames:
    """The frames to animate from: of every stretch the one that hides least, and both ends.

    Args:
        clarity: (n,) how much of the body is seen in each frame, in [0, 1]; NaN: no pose.
        apart: Length of a stretch, in frames: so many key frames that a movement which takes
            two stretches is not passed over.

    Returns:
        Places in `clarity`, in order; empty where there is no pose at all.
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


def between(keys: Frames, motion: Motion, frames: Frames) -> Motion:
    """The motion at `frames`: exact at the key frames, the shorter way round between them.

    Args:
        keys: (k,) increasing frames, at least one.
        motion: At the key frames: k rows.
        frames: Any; before the first key and after the last the pose is held.
    """
    late = np.clip(np.searchsorted(keys, frames, side="right"), 1, max(1, len(keys) - 1))
    late = np.minimum(late, len(keys) - 1)
    early = np.maximum(late - 1, 0)
    span = np.maximum(keys[late] - keys[early], 1)
    share = np.clip((frames - keys[early]) / span, 0.0, 1.0)
    root = motion.root_m[early] + share[:, None] * (motion.root_m[late] - motion.root_m[early])
    turns = slerp(motion.turns[early], motion.turns[late], share[:, None])
    exact = share[:, None, None]
    return Motion(
        np.where(share[:, None] == 1.0, motion.root_m[late], root),
        np.where(
            exact == 0.0, motion.turns[early], np.where(exact == 1.0, motion.turns[late], turns)
        ),
    )
