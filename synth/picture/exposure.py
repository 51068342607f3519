"""Place and exposure of the cameras: the default rig, gain over time, frames with motion blur."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Rig, paper_rig
from synth.motion.motions import Motion

BLUR_M: Final = 0.06
"""Displacement of a joint per frame from which on the picture is blurred."""
FLICKER_HZ: Final = (1.3, 3.1)
"""Frequencies of the lamp's flicker that remain at the cameras' rate."""


def default_rig(width: int, height: int) -> Rig:
    """Two level cameras 1 m high, 4.5 m from the middle, one before and one at the right side."""
    focal = 401.14 * width / 320
    return paper_rig((width, height), (focal, focal), (4.5, 4.5))


def exposures(cameras: int, count: int, seed: int, fps: float) -> Vector:
    """Gain of each frame, (cameras, count): flicker and a step of the exposure."""
    rng = np.random.default_rng([seed, 2])
    t = np.arange(count) / fps
    flicker = 0.006 * np.sin(2 * np.pi * (np.outer(FLICKER_HZ, t) + rng.random((2, 1)))).sum(axis=0)
    gains = rng.uniform(0.92, 1.12) * rng.uniform(0.97, 1.03, (cameras, 1)) * (1.0 + flicker)
    for gain in gains:
        if rng.random() < 0.5:
            gain[int(rng.integers(count // 3, count)) :] *= 1.0 + rng.uniform(-0.04, 0.04)
    return gains


def blurred(motion: Motion) -> NDArray[np.bool_]:
    """Which frames (n,) have motion blur."""
    moved = np.linalg.norm(np.diff(motion.joints_m, axis=0), axis=-1).max(axis=-1)
    return np.append(False, np.nan_to_num(moved) > BLUR_M)
