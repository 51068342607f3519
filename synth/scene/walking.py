"""A script as a motion: a gait whose strides are as long as the way, and gestures on top."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.motion.footing import posed
from synth.motion.motions import (
    OPENING_S,
    TPOSE,
    Act,
    Course,
    Motion,
    opened,
    performed,
    staged,
    stance,
    sway,
)
from synth.motion.moves import Track, walk_toward
from synth.person.people import Person, Style, take_style
from synth.person.skeleton import ANGLES
from synth.scene.script import Floor, Gesture, Script, headings, places

FULL_GAIT_M_S: Final = 0.4
"""Speed from which on the gait has its full amplitude."""
MEASURED_S: Final = 6.0
"""Duration of the walk by which a person's natural speed is measured."""
OPENED_S: Final = sum(OPENING_S)
"""Duration of the empty room, the T-pose and the lowering of the arms."""


def acted(
    someone: Person, script: Script, phase: NDArray[np.uint8], fps: float, seed: int
) -> Motion:
    """The motion of a person who follows a script.

    Args:
        someone: The person.
        script: Where they are, and what they do.
        phase: (n,) phase of each frame; EMPTY while they are out of the room.
        fps: Frames per second.
        seed: Seed of the style of this take and of the sway.
    """
    rng = np.random.default_rng([someone.seed, seed, *b"scene"])
    time_s = np.arange(len(phase)) / fps
    path_m = places(script, time_s)
    style = take_style(someone.style, rng)._replace(x0=path_m[0, 0], z0=path_m[0, 1])
    still = stance(style, time_s)
    still["root_yaw"] = headings(script, time_s)
    angles_deg = _gait(someone, style, path_m, still, fps)
    for gesture in script.gestures:
        angles_deg += _gestured(gesture, style, still, time_s)
    if (phase == TPOSE).any():
        angles_deg = opened(angles_deg, opening_phase(len(phase), fps), fps)
    angles_deg += sway(style, time_s, rng)
    motion = staged(someone, Course("scene", fps, angles_deg, phase, style, path_m))
    acts = (Act(g.name, round(g.from_s * fps), round(g.to_s * fps)) for g in script.gestures)
    return motion._replace(acts=tuple(act for act in acts if act.first < len(phase)))


def opening_phase(count: int, fps: float) -> NDArray[np.uint8]:
    """Phases of a person who performs the opening and stays, (n,)."""
    ends = np.cumsum([round(s * fps) for s in OPENING_S])
    return np.searchsorted(ends, np.arange(count), side="right").astype(np.uint8)


def _gait(
    someone: Person, style: Style, path_m: Floor, still: Track, fps: float
) -> NDArray[np.float64]:
    """Joint angles (n, 27): strides along the path, a stance where it rests."""
    steps_m = np.diff(path_m, axis=0, prepend=path_m[:1])
    yaw = np.radians(still["root_yaw"])
    ahead_m = (steps_m * np.stack([np.sin(yaw), np.cos(yaw)], axis=1)).sum(axis=1)
    speed = np.linalg.norm(steps_m, axis=1) * fps
    walks = np.convolve(np.clip(speed / FULL_GAIT_M_S, 0.0, 1.0), np.full(3, 1 / 3), mode="same")
    time_s = np.cumsum(ahead_m) / _natural_m_s(someone, style, fps)
    strides = walk_toward(time_s, style, still)
    columns = [
        still[name] + walks * (strides.get(name, still[name]) - still[name]) for name in ANGLES
    ]
    return np.stack(columns, axis=1)


def _natural_m_s(someone: Person, style: Style, fps: float) -> float:
    """Speed at which the gait moves a person over the floor."""
    time_s = np.arange(round(MEASURED_S * fps)) / fps
    strides = {**stance(style, time_s), "root_yaw": np.zeros_like(time_s)}
    strides |= walk_toward(time_s, style, strides)
    body = posed(
        someone.measures, np.stack([strides[name] for name in ANGLES], axis=1), np.zeros(2)
    )
    return float(body.joints_m[-1, 0, 2] - body.joints_m[0, 0, 2]) / float(time_s[-1])


def _gestured(gesture: Gesture, style: Style, still: Track, time_s: Vector) -> NDArray[np.float64]:
    """What a gesture adds to the joint angles, (n, 27)."""
    _, from_s, to_s, move = gesture
    during = (time_s >= from_s) & (time_s < to_s)
    added = np.zeros((len(time_s), len(ANGLES)))
    if during.any():
        own = {name: values[during] for name, values in still.items()}
        lasts = performed(move, own, time_s[during] - from_s, style, to_s - from_s)
        added[during] = lasts - np.stack([own[name] for name in ANGLES], axis=1)
    return added
