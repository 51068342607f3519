"""A person who is there from the first frame and stays on one spot."""

from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.motion.idling import resting, scratching, shifting
from synth.motion.motions import MOTION, Course, Motion, performed, staged, stance, sway
from synth.motion.moves import MOTION_S, MOVES, Move, Track, smooth
from synth.person.people import Person, Style, take_style

SPOT_S: Final = 6.0
"""Duration of a take."""
PIECE_S: Final = (1.6, MOTION_S)
"""Duration of one behaviour."""
HEADING_DEG: Final = 40.0
"""Range of the heading, each way from camera 1."""
BENT_DEG: Final = (25.0, 60.0)
TURNED_DEG: Final = (25.0, 70.0)
STEPS: Final = ("walk", "kick")
"""First words of the postures that lift a foot."""


def bending(bent_deg: float) -> Move:
    """Down from the hips with hanging arms, and up."""

    def move(t: Vector, _style: Style, still: Track) -> Track:
        down = bent_deg * _there_and_back(t)
        found = {"torso_pitch": still["torso_pitch"] + 0.6 * down, "root_pitch": 0.4 * down}
        for side in "lr":
            found[f"{side}_hip_flex"] = still[f"{side}_hip_flex"] + 0.4 * down
            found[f"{side}_sh_flex"] = still[f"{side}_sh_flex"] + down
        return found

    return move


def turning(turned_deg: float) -> Move:
    """The whole body to a side, and back."""

    def move(t: Vector, _style: Style, still: Track) -> Track:
        return {"root_yaw": still["root_yaw"] + turned_deg * _there_and_back(t)}

    return move


def _there_and_back(t: Vector) -> Vector:
    """0, rising to 1, back to 0 within the shortest behaviour."""
    return smooth(t / 0.7) * smooth((PIECE_S[0] - t) / 0.7)


def _as_it_is(move: Move, _rng: np.random.Generator) -> Move:
    return move


ON_SPOT: Final[dict[str, Callable[[np.random.Generator], Move]]] = {
    **{
        name: partial(_as_it_is, move)
        for name, move in MOVES.items()
        if name.split("_")[0] not in STEPS
    },
    "shift": partial(_as_it_is, shifting),
    "scratch": lambda rng: scratching("lr"[int(rng.integers(2))]),
    "hands on hips": lambda _rng: resting(-8.0, 42.0, -40.0, 92.0),
    "bend": lambda rng: bending(float(rng.uniform(*BENT_DEG))),
    "turn": lambda rng: turning(float(rng.uniform(*TURNED_DEG) * rng.choice([-1.0, 1.0]))),
}
"""Behaviours for which no foot leaves its place."""


def on_spot(someone: Person, seed: int, fps: float = 15.0) -> Motion:
    """One take without an empty room: behaviours in random order on one spot.

    Args:
        someone: The performer.
        seed: Seed of the take.
        fps: Frames a second.
    """
    rng = np.random.default_rng([someone.seed, seed, *b"spot"])
    style = take_style(someone.style, rng)
    style = style._replace(yaw=float(rng.uniform(-HEADING_DEG, HEADING_DEG)))
    count = round(SPOT_S * fps)
    pieces: list[NDArray[np.float64]] = []
    while sum(len(piece) for piece in pieces) < count:
        move = ON_SPOT[list(ON_SPOT)[int(rng.integers(len(ON_SPOT)))]](rng)
        lasts_s = float(rng.uniform(*PIECE_S))
        time_s = np.arange(round(lasts_s * fps)) / fps
        pieces.append(performed(move, stance(style, time_s), time_s, style, lasts_s))
    angles_deg = np.concatenate(pieces)[:count] + sway(style, np.arange(count) / fps, rng)
    phase, place = np.full(count, MOTION, np.uint8), np.tile((style.x0, style.z0), (count, 1))
    return staged(someone, Course("spot", fps, angles_deg, phase, style, place))
