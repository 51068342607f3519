"""Behaviour between postures: standing, small shifts, scratching, steps back, and others."""

from collections.abc import Callable
from typing import Final

import numpy as np

from common.body.body import Vector
from synth.motion.moves import MOTION_S, MOVES, Move, Track
from synth.motion.roaming import roaming
from synth.person.people import Style
from synth.person.skeleton import ANGLES

HEADING_SHARE: Final = 0.25
"""Factor on the turns of free motion: between two postures people keep roughly their heading."""

RETURNS: Final = ("walk_sideways", "walk_toward", "walk_slow_bigswing")
"""Postures that lead away: afterwards the person steps back to their place."""


def standing(_t: Vector, _style: Style, _still: Track) -> Track:
    """Only the sway."""
    return {}


def shifting(t: Vector, _style: Style, still: Track) -> Track:
    """The weight shifts from one leg to the other, the trunk follows, the head looks around."""
    wave = np.sin(2 * np.pi * 0.4 * t)
    found = {"root_roll": 3.0 * wave, "torso_yaw": 9.0 * wave, "head_yaw": 35.0 * wave}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        found[f"{side}_hip_abd"] = still[f"{side}_hip_abd"] + 3.0 * sign * wave
        found[f"{side}_knee"] = still[f"{side}_knee"] + 8.0 * np.maximum(sign * wave, 0.0)
    return found


def scratching(side: str) -> Move:
    """A hand at the head."""

    def move(t: Vector, _style: Style, _still: Track) -> Track:
        rub = np.sin(2 * np.pi * 3.0 * t)
        return {
            f"{side}_sh_flex": 62.0 + 3.0 * rub,
            f"{side}_sh_abd": np.full_like(t, 30.0),
            f"{side}_elbow": 122.0 + 6.0 * rub,
            "head_pitch": np.full_like(t, 10.0),
        }

    return move


def resting(flex_deg: float, abd_deg: float, twist_deg: float, elbow_deg: float) -> Move:
    """Both arms at rest in another place: on the hips, crossed, at a button."""

    def move(t: Vector, _style: Style, _still: Track) -> Track:
        level = {"sh_flex": flex_deg, "sh_abd": abd_deg, "sh_twist": twist_deg, "elbow": elbow_deg}
        return {
            f"{side}_{name}": np.full_like(t, value)
            for side in "lr"
            for name, value in level.items()
        }

    return move


def stepping_back(posture: str) -> Move:
    """The steps of a posture reversed in time: back to the place where it began."""

    def move(t: Vector, s: Style, still: Track) -> Track:
        return MOVES[posture](MOTION_S - t, s, still)

    return move


def anything(rng: np.random.Generator) -> Move:
    """Joints through their whole ranges, at random."""

    def move(t: Vector, _style: Style, still: Track) -> Track:
        seeded = np.random.default_rng(seed)
        angles_deg, _ = roaming(still, np.maximum(t, 0.0), seeded)
        found = {name: angles_deg[:, i] for i, name in enumerate(ANGLES)}
        heading = still["root_yaw"]
        found["root_yaw"] = heading + HEADING_SHARE * (found["root_yaw"] - heading)
        return found

    seed = int(rng.integers(2**32))
    return move


IDLE: Final[dict[str, Callable[[np.random.Generator], Move]]] = {
    "shift": lambda _rng: shifting,
    "scratch": lambda rng: scratching("lr"[int(rng.integers(2))]),
    "hands on hips": lambda _rng: resting(-8.0, 42.0, -40.0, 92.0),
    "button": lambda _rng: resting(24.0, 12.0, 45.0, 105.0),
    "anything": anything,
}
"""Behaviours in a pause, besides standing."""
