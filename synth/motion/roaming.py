"""Free motion: a person turns, steps, bends and reaches, every joint through its range."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.person.skeleton import ANGLES

FREE_S: Final = 16.0
"""Duration: long enough for every joint to reach both ends of its range."""

KEYS: Final = 36
"""Number of poses on the way, one every 0.44 s: an arm that crosses its range between two of
them moves faster than 300 degrees a second."""

FREE_RANGES_DEG: Final[dict[str, tuple[float, float]]] = {
    "torso_pitch": (-10.0, 35.0),
    "torso_roll": (-15.0, 15.0),
    "torso_yaw": (-25.0, 25.0),
    "head_pitch": (-25.0, 25.0),
    "head_yaw": (-45.0, 45.0),
    "head_roll": (-15.0, 15.0),
    "sh_abd": (0.0, 150.0),
    "sh_flex": (-40.0, 160.0),
    "sh_twist": (-40.0, 70.0),
    "elbow": (3.0, 125.0),
    "hip_abd": (0.0, 40.0),
    "hip_flex": (-15.0, 85.0),
    "hip_twist": (0.0, 25.0),
    "knee": (3.0, 110.0),
    "root_pitch": (-6.0, 18.0),
    "root_roll": (-6.0, 6.0),
}
"""Range of each joint, by its name in ANGLES without the side."""

ARM_CROWDING_DEG: Final = 190.0
"""Bound of a shoulder's abduction and flexion together: beyond, the arm would pass through the
head."""

TURN_DEG: Final = 720.0
"""Range of the body's yaw: every facing at least once."""

ROOM_M: Final = 0.6
"""Range of the person's place about the middle, each way."""


class Leg(NamedTuple):
    """The supporting leg at each of the KEYS poses."""

    free: NDArray[np.bool_]
    """(KEYS, 2) the leg (left, right) that is in the air."""
    squat: Vector
    """(KEYS,) bend of both, 0 to 1."""


def roaming(
    stance: dict[str, Vector], t: Vector, rng: np.random.Generator
) -> tuple[NDArray[np.float64], Vector]:
    """Joint angles (n, 27) and the places that attract the pelvis (n, 2).

    Args:
        stance: The standing pose, (n,) for each angle's name: where the motion starts.
        t: (n,) seconds since the motion began.
        rng: Source of the random poses.
    """
    at = np.linspace(0.0, FREE_S, KEYS + 2)
    leg = _legs(rng)
    columns = []
    for name in ANGLES:
        keys = _keys(name, leg, rng)
        first = float(stance[name][0])
        if name == "root_yaw":
            columns.append(first + _turning(t, rng))
            continue
        columns.append(_between(t, at, np.array([first, *keys, first])))
    angles = np.stack(columns, axis=1)
    angles = _uncrowded(angles)
    path = np.stack(
        [
            _between(t, at, np.array([0.0, *rng.uniform(-ROOM_M, ROOM_M, KEYS), 0.0]))
            for _ in range(2)
        ],
        axis=1,
    )
    return angles, path


def _legs(rng: np.random.Generator) -> Leg:
    """Alternately: left leg free, right leg free, both bent."""
    kind = rng.permuted(np.arange(KEYS) % 3)
    squat = np.where(kind == 2, _spread(KEYS, rng), 0.0)
    return Leg(np.stack([kind == 0, kind == 1], axis=1), squat)


def _keys(name: str, leg: Leg, rng: np.random.Generator) -> Vector:
    """The KEYS values of one joint: evenly distributed over its range, in random order."""
    side, joint = (name[0], name[2:]) if name[1] == "_" else ("", name)
    if joint == "root_yaw":
        return np.zeros(KEYS)
    if joint == "foot":
        return leg.free[:, "lr".index(side)].astype(float)
    low, high = FREE_RANGES_DEG[joint]
    values = low + (high - low) * _spread(KEYS, rng)
    if joint in ("hip_flex", "knee", "hip_abd"):
        free = leg.free[:, "lr".index(side)]
        values[free] = low + (high - low) * _spread(int(free.sum()), rng)
        bent = {"hip_flex": 80.0, "knee": 98.0, "hip_abd": 12.0}[joint]
        values[~free] = 4.0 + bent * leg.squat[~free]
    return values


def _spread(count: int, rng: np.random.Generator) -> Vector:
    """`count` numbers from 0 to 1, both ends among them, in random order."""
    spread: Vector = rng.permuted(np.linspace(0.0, 1.0, count))
    return spread


def _turning(t: Vector, rng: np.random.Generator) -> Vector:
    """Yaw with varying speed, sometimes reversed."""
    wander = np.sin(2 * np.pi * (np.outer(t / FREE_S, [2.0, 3.0, 5.0]) + rng.random(3)))
    way = (wander - wander[np.argmin(np.abs(t))]) @ np.array([40.0, 25.0, 12.0])
    turned: Vector = np.where(t > 0, TURN_DEG * np.clip(t / FREE_S, 0, 1) + way, 0.0)
    return turned * rng.choice([-1.0, 1.0])


def _between(t: Vector, at: Vector, values: Vector) -> Vector:
    """Interpolation of the values, with zero speed at each."""
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, len(at) - 2)
    x = np.clip((t - at[i]) / (at[i + 1] - at[i]), 0.0, 1.0)
    found: Vector = values[i] + (values[i + 1] - values[i]) * x * x * (3.0 - 2.0 * x)
    return found


def _uncrowded(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Reduced flexion of arms that are abducted far."""
    found = angles.copy()
    for side in "lr":
        abd, flex = (ANGLES.index(f"{side}_sh_{name}") for name in ("abd", "flex"))
        both = np.abs(angles[:, abd]) + np.abs(angles[:, flex])
        found[:, flex] *= np.minimum(1.0, ARM_CROWDING_DEG / np.maximum(both, 1.0))
    return found
