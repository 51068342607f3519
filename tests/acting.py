"""Made-up performers of the fifteen postures: plain angle motions, each in a style of its own."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLE_INDEX, ANGLE_NAMES, REST_DEG
from recognizer.postures import POSTURES

Array = NDArray[np.float64]
Moves = dict[str, Array]
"""By how much each named angle differs from its rest, degrees."""


def both(joint: str, change: Array) -> Moves:
    """The same change of both sides, outwards being lower on the right, higher on the left."""
    return {f"r_{joint}": -change, f"l_{joint}": change}


def equal(joint: str, change: Array) -> Moves:
    return {f"r_{joint}": change, f"l_{joint}": change}


def opposed(joint: str, change: Array) -> Moves:
    return {f"r_{joint}": change, f"l_{joint}": -change}


# s swings between -1 and 1, u rises from 0 to 1 and falls again
MOTIONS: dict[str, Callable[[Array, Array], Moves]] = {
    "walk_in_place": lambda s, u: {
        "r_hip_x": 45 * np.maximum(s, 0),
        "l_hip_x": 45 * np.maximum(-s, 0),
    },
    "walk_sideways": lambda s, u: both("hip_z", 18 * u),
    "walk_toward": lambda s, u: opposed("hip_x", 25 * s) | opposed("shoulder_x", -15 * s),
    "walk_slow_bigswing": lambda s, u: opposed("hip_x", 15 * s) | opposed("shoulder_x", -45 * s),
    "raise_right_lateral": lambda s, u: {"r_shoulder_z": -85 * u},
    "raise_left_lateral": lambda s, u: {"l_shoulder_z": 85 * u},
    "raise_both_lateral": lambda s, u: both("shoulder_z", 110 * u),
    "raise_both_forward_up": lambda s, u: equal("shoulder_x", 150 * u),
    "swing_right_circles": lambda s, u: {"r_shoulder_x": 180 * s},
    "swing_both_backforth": lambda s, u: equal("shoulder_x", 55 * s),
    "swing_both_overhead_wave": lambda s, u: {
        "r_shoulder_z": -155 + 20 * s,
        "l_shoulder_z": 155 + 20 * s,
    },
    "squat": lambda s, u: equal("hip_x", 60 * u),
    "squat_arms_forward": lambda s, u: equal("hip_x", 60 * u) | equal("shoulder_x", 80 * u),
    "kick_right_forward": lambda s, u: {"r_hip_x": 75 * u},
    "kick_left_side": lambda s, u: {"l_hip_z": 55 * u},
}


PATHS: dict[str, Callable[[Array, Array], Array]] = {
    "walk_sideways": lambda s, u: np.stack([0.5 * s, 0 * s, 0 * s], axis=1),
    "walk_toward": lambda s, u: np.stack([0 * s, 0.02 * u, 1.0 * s], axis=1),
    "walk_slow_bigswing": lambda s, u: np.stack([0 * s, 0.02 * u, 0.5 * s], axis=1),
    "squat": lambda s, u: np.stack([0 * s, -0.4 * u, 0 * s], axis=1),
    "squat_arms_forward": lambda s, u: np.stack([0 * s, -0.4 * u, 0 * s], axis=1),
}
"""Where the root goes meanwhile, leg lengths from where it stood; the others stay."""


def standing(frames: int) -> Array:
    """Arms and legs hanging, shape (frames, 20)."""
    rest = [REST_DEG.get(name, 15.0 if "elbow" in name else 0.0) for name in ANGLE_NAMES]
    return np.tile([*rest, 0.0, 1.05, 0.0], (frames, 1))


def perform(posture: str, performer: int, take: int = 1, frames: int = 40) -> Array:
    """One performance, (frames, 20): a performer's own reach, pace and delay, and noise."""
    style = np.random.default_rng([performer, list(POSTURES).index(posture)])
    reach, pace = style.uniform(0.85, 1.15, 2)
    delay = style.uniform(-0.5, 0.5)
    phase = 2 * np.pi * pace * np.arange(frames) / 20 + delay
    swing = np.sin(phase), (1 - np.cos(phase)) / 2
    rows = standing(frames)
    for name, change in MOTIONS[posture](*swing).items():
        rows[:, ANGLE_INDEX[name]] += reach * change
    if posture in PATHS:
        rows[:, len(ANGLE_NAMES) :] += reach * PATHS[posture](*swing)
    noise = np.random.default_rng([performer, list(POSTURES).index(posture), take])
    rows[:, : len(ANGLE_NAMES)] += noise.normal(0.0, 3.0, (frames, len(ANGLE_NAMES)))
    rows[:, len(ANGLE_NAMES) :] += noise.normal(0.0, 0.005, (frames, 3))
    return rows


def performances(performers: range, takes: int = 1) -> dict[str, list[Array]]:
    """What `train` takes: every posture by every performer."""
    return {
        posture: [perform(posture, who, take) for who in performers for take in range(takes)]
        for posture in POSTURES
    }
