"""A second person who walks past one who stays on a spot."""

from typing import Final

import numpy as np

from synth.motion.motions import MOTION, Course, Motion, performed, staged, stance, sway
from synth.motion.moves import walk_toward
from synth.person.people import Person, take_style

BESIDE_M: Final = (0.75, 1.1)
"""Range of the distance of the way from the room's middle, where the other one stands, metres."""
HEADINGS_DEG: Final = (90.0, -90.0, 0.0, 180.0, 60.0, -120.0)
"""Directions of the way; 0 is towards camera 1."""
ASTRAY_DEG: Final = 12.0
"""Range of the difference from those, each way."""


def crossing(someone: Person, seed: int, beside: Motion) -> Motion:
    """A walk past a person, from one side of the room to the other, in the same frames.

    Args:
        someone: Who walks.
        seed: Seed of the take.
        beside: The motion of the person who stays.
    """
    rng = np.random.default_rng([someone.seed, seed, *b"cross"])
    style, fps, count = take_style(someone.style, rng), beside.fps, len(beside.phase)
    heading_deg = float(rng.choice(HEADINGS_DEG) + rng.uniform(-ASTRAY_DEG, ASTRAY_DEG))
    aside_m = float(rng.choice([-1.0, 1.0]) * rng.uniform(*BESIDE_M))
    heading = np.radians(heading_deg)
    style = style._replace(
        yaw=heading_deg,
        x0=float(aside_m * np.cos(heading)),
        z0=float(-aside_m * np.sin(heading)),
    )
    time_s = np.arange(count) / fps
    steps = performed(walk_toward, stance(style, time_s), time_s, style, count / fps)
    angles_deg = steps + sway(style, time_s, rng)
    phase = np.full(count, MOTION, np.uint8)
    return staged(someone, Course("cross", fps, angles_deg, phase, style, None))
