"""A dance that turns: it stands in for the thesis's second video, which is lost (T24, T27)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.motion.footing import posed
from synth.motion.motions import MOTION, Motion
from synth.motion.moves import smooth
from synth.person.people import Person, take_style
from synth.person.skeleton import ANGLES, JOINTS

FRAMES: Final = 200
"""As many as the thesis's dancing video has (4.1)."""
FACING_DEG: Final = (-40.0, -90.0, -140.0, 140.0, 90.0, 40.0, -35.0, -90.0)
"""Where the dancer faces, one after the other: 0 to camera 1, 90 to the right of its picture. In
the thesis's six words each differs from the one before, which makes its 7 changes (4.3)."""
TURN_S: Final = 0.5
"""How long a turn takes."""
SIDE_DEG: Final = 20.0
"""So near to the side nobody faces the camera, or away from it."""
BEAT_HZ: Final = 0.9
SWAY_M, SWAY_S = 0.9, 6.0
"""How far the dancer goes to either side, and how long to and fro takes: no part of the room is
hidden for long, as a background that is learnt from the video itself wants it (T7)."""

SWINGS_DEG: Final = {
    "sh_abd": (35.0, 30.0, 1.0),
    "sh_flex": (25.0, 50.0, 1.0),
    "elbow": (50.0, 40.0, 2.0),
    "hip_flex": (18.0, 18.0, 1.0),
    "knee": (34.0, 30.0, 1.0),
}
"""Middle and size of each joint's swing, and its times a beat; left and right take turns."""


def dance(someone: Person, seed: int, fps: float = 15.0) -> Motion:
    """FRAMES frames of dancing, somebody in view from the first to the last.

    Args:
        someone: Who dances.
        seed: Of the take.
        fps: Frames a second.
    """
    rng = np.random.default_rng([someone.seed, seed, *b"dance"])
    style = take_style(someone.style, rng)
    time_s = np.arange(FRAMES) / fps
    track = {name: np.zeros(FRAMES) for name in ANGLES}
    for joint, (middle, size, times) in SWINGS_DEG.items():
        phase = rng.uniform(-0.2, 0.2)
        for side, lead in (("l", 0.0), ("r", 0.5)):
            beat = np.sin(2 * np.pi * (times * BEAT_HZ * time_s + times * lead + phase))
            track[f"{side}_{joint}"] = middle + style.amp * size * beat
    track["root_yaw"] = _facing(time_s)
    track["torso_pitch"] = 6.0 + 6.0 * np.sin(2 * np.pi * BEAT_HZ * time_s)
    angles_deg = np.stack([track[name] for name in ANGLES], axis=1)
    path = np.stack([SWAY_M * np.sin(2 * np.pi * time_s / SWAY_S), np.zeros(FRAMES)], axis=1)
    body = posed(someone.measures, angles_deg, path[0], path)
    return Motion(
        posture="free",
        fps=fps,
        joints_m=body.joints_m,
        bones=body.bones,
        angles_deg=angles_deg,
        root_m=body.joints_m[:, 0].copy(),
        phase=np.full(FRAMES, MOTION, np.uint8),
        style=style,
    )


def faced(motion: Motion) -> NDArray[np.str_]:
    """Which way a body faces in each frame, in the thesis's six words (T22); within SIDE_DEG of the
    side, left or right."""
    left, right = (motion.joints_m[:, JOINTS.index(f"{side}_shoulder")] for side in "lr")
    forward = np.cross(left - right, (0.0, 1.0, 0.0))
    yaw_deg = np.degrees(np.arctan2(forward[:, 0], forward[:, 2]))
    off_deg = np.abs(yaw_deg) - 90.0
    depth = np.where(off_deg < -SIDE_DEG, "forward_", np.where(off_deg > SIDE_DEG, "backward_", ""))
    return np.char.add(depth, np.where(yaw_deg < 0, "left", "right"))


def _facing(time_s: Vector) -> Vector:
    """Yaw over time: rests at each of FACING_DEG as long as at the others, and turns quickly."""
    rest_s = (time_s[-1] + time_s[1]) / len(FACING_DEG)
    yaw = np.full(len(time_s), FACING_DEG[0])
    for n, step in enumerate(np.diff(FACING_DEG), start=1):
        shorter = step - 360.0 * np.rint(step / 360.0)
        yaw += shorter * smooth((time_s - n * rest_s) / TURN_S + 0.5)
    return yaw
