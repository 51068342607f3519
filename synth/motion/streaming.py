"""A stream: one posture after the other in random order, with pauses, and the times of each."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.motion.idling import IDLE, RETURNS, standing, stepping_back
from synth.motion.motions import (
    LOWERING,
    MOTION,
    OPENING_S,
    POSTURES,
    Act,
    Course,
    Motion,
    opened,
    performed,
    staged,
    stance,
    sway,
)
from synth.motion.moves import MOTION_S, MOVES, Move
from synth.person.people import Person, Style, take_style

Angles = NDArray[np.float64]

PAUSE_S: Final = (0.7, 1.8)
"""Standing time before and after a behaviour in a pause."""
IDLE_S: Final = (1.5, 4.0)
IDLE_SHARE: Final = 0.6
"""Share of the pauses with more than standing."""
STANCE: Final = ("carry", "elbow", "stance", "toe", "lean", "headp", "yaw", "x0", "z0")
"""Parts of a style that are constant within a stream: the stance."""
ROOM_M: Final = (-0.2, -0.8)
"""Starting places in a stream, x and z from the usual place: a person who walks needs room."""
LEFT_DEG: Final = 5.0
"""Deviation of a joint from its stance that belongs to a performance."""


class Piece(NamedTuple):
    """A stretch of a stream, from stance to stance."""

    angles_deg: Angles
    """(n, 27), without sway."""
    posture: str = ""
    """"" in a pause."""
    returns: bool = False
    """True: the person returns to their place."""


def streamed(
    someone: Person, seed: int, fps: float = 15.0, postures: tuple[str, ...] = POSTURES
) -> Motion:
    """One long take: the opening, then every posture once with pauses between.

    Args:
        someone: The performer.
        seed: Seed of the take.
        fps: Frames a second.
        postures: The postures; their order is random.
    """
    rng = np.random.default_rng([someone.seed, seed, *b"stream"])
    style = take_style(someone.style, rng)
    style = style._replace(x0=style.x0 + ROOM_M[0], z0=style.z0 + ROOM_M[1])
    pieces = _pieces(style, postures, fps, rng)
    lasts = [*(round(s * fps) for s in OPENING_S), sum(len(piece.angles_deg) for piece in pieces)]
    phase = np.repeat(np.array([*range(LOWERING + 1), MOTION], np.uint8), lasts)
    opening = Piece(_moved(standing, style, fps, sum(lasts[:-1]) / fps))
    pieces = [opening, *pieces]
    moved = opened(np.concatenate([piece.angles_deg for piece in pieces]), phase, fps)
    angles_deg = moved + sway(style, np.arange(len(phase)) / fps, rng)
    leash = np.concatenate([_leash(piece, style) for piece in pieces])
    motion = staged(someone, Course("stream", fps, angles_deg, phase, style, leash))
    return motion._replace(acts=_acts(pieces))


def _pieces(
    style: Style, postures: tuple[str, ...], fps: float, rng: np.random.Generator
) -> list[Piece]:
    found = _pause(style, "", fps, rng)
    for posture in rng.permutation(postures).tolist():
        take = take_style(style, rng)._replace(**{n: getattr(style, n) for n in STANCE})
        found.append(Piece(_moved(MOVES[posture], take, fps, MOTION_S), posture))
        found += _pause(style, posture, fps, rng)
    return found


def _pause(style: Style, after: str, fps: float, rng: np.random.Generator) -> list[Piece]:
    """Standing, mostly with a behaviour in the middle; steps back where needed."""

    def stand() -> Piece:
        return Piece(_moved(standing, style, fps, rng.uniform(*PAUSE_S)))

    found = [stand()]
    if after in RETURNS:
        found += [Piece(_moved(stepping_back(after), style, fps, MOTION_S), returns=True), stand()]
    if rng.random() < IDLE_SHARE:
        move = IDLE[list(IDLE)[int(rng.integers(len(IDLE)))]](rng)
        lasts_s = rng.uniform(*IDLE_S)
        found += [Piece(_moved(move, style, fps, lasts_s), returns=True), stand()]
    return found


def _moved(move: Move, style: Style, fps: float, lasts_s: float) -> Angles:
    """The joint angles of a movement from stance to stance, (n, 27)."""
    time_s = np.arange(round(lasts_s * fps)) / fps
    return performed(move, stance(style, time_s), time_s, style, lasts_s)


def _leash(piece: Piece, style: Style) -> Vector:
    """Places that attract the pelvis, (n, 2): its own place, or none."""
    place = (style.x0, style.z0) if piece.returns else (np.nan, np.nan)
    return np.tile(place, (len(piece.angles_deg), 1))


def _acts(pieces: list[Piece]) -> tuple[Act, ...]:
    """The performances: from the first to the last frame in which a joint is away from its
    stance."""
    found, at = [], 0
    for piece in pieces:
        if piece.posture:
            gone_deg = np.abs(piece.angles_deg - piece.angles_deg[0]).max(axis=1)
            left = np.flatnonzero(gone_deg > LEFT_DEG)
            found.append(Act(piece.posture, at + int(left[0]), at + int(left[-1])))
        at += len(piece.angles_deg)
    return tuple(found)
