"""A person's script in a scene: where they walk, how they turn, what they do, and when."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from common.body.body import Vector
from synth.motion.moves import Move

Floor = NDArray[np.float64]
"""(..., 2) x and z on the floor, metres."""

RAMP_S: Final = 0.45
"""Time in which a walk reaches its speed, and in which it ends."""
TURN_S: Final = 0.16
"""Standard deviation of the smoothing of a heading: a half turn takes about 0.6 s."""
STILL_M_S: Final = 0.05
"""Speed below which a walk has no direction."""


class Walk(NamedTuple):
    """A way over the floor."""

    from_s: float
    to_s: float
    points_m: Floor
    """(k, 2) from start to end, at least two; the way is a smooth curve through them."""
    facing_deg: float | None = None
    """Constant heading, for steps back and aside; None: along the way."""


class Turn(NamedTuple):
    """A heading from a time on, until a walk."""

    from_s: float
    facing_deg: float
    """0 faces +z, 90 faces +x."""


class Gesture(NamedTuple):
    """A movement of the body at a place."""

    name: str
    from_s: float
    to_s: float
    move: Move


class Script(NamedTuple):
    """All that one person does; times are seconds from the start of the clip."""

    start_m: Floor
    """(2,) first place."""
    walks: tuple[Walk, ...] = ()
    """In order of time, each from the end of the one before."""
    turns: tuple[Turn, ...] = ()
    gestures: tuple[Gesture, ...] = ()

    @property
    def end_m(self) -> Floor:
        """(2,) last place."""
        return self.walks[-1].points_m[-1] if self.walks else self.start_m


def places(script: Script, time_s: Vector) -> Floor:
    """Place at each time, (n, 2)."""
    found = np.tile(np.asarray(script.start_m, np.float64), (len(time_s), 1))
    for walk in script.walks:
        begun = time_s >= walk.from_s
        found[begun] = _along(walk, time_s[begun])
    return found


def headings(script: Script, time_s: Vector) -> Vector:
    """Heading at each time, degrees, (n,), without jumps of a whole turn."""
    wanted = np.zeros(len(time_s))
    events: list[Turn | Walk] = [*script.turns, *script.walks]
    events.sort(key=lambda event: event.from_s)
    for event in events:
        begun = time_s >= event.from_s
        if isinstance(event, Turn):
            wanted[begun] = event.facing_deg
        else:
            wanted[begun] = _heading(event, time_s[begun])
    turned = np.degrees(np.unwrap(np.radians(wanted)))
    reach = np.arange(-4.0 * TURN_S, 4.0 * TURN_S, time_s[1] - time_s[0])
    weights = np.exp(-0.5 * (reach / TURN_S) ** 2)
    padded = np.pad(turned, (len(reach) // 2, (len(reach) - 1) // 2), mode="edge")
    smoothed: Vector = np.convolve(padded, weights / weights.sum(), mode="valid")
    return smoothed


def towards_deg(from_m: Floor, to_m: Floor) -> float:
    """Heading from a place to another."""
    x, z = to_m - from_m
    return float(np.degrees(np.arctan2(x, z)))


def length_m(points_m: Floor) -> float:
    """Length of a way through some points, about."""
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=1).sum())


def _along(walk: Walk, time_s: Vector) -> Floor:
    """Places on a walk at times since its start; its end after it."""
    lasts_s = walk.to_s - walk.from_s
    ramp = min(RAMP_S, lasts_s / 2)
    t = np.clip(time_s - walk.from_s, 0.0, lasts_s)
    first, last = np.minimum(t, ramp), np.maximum(t - (lasts_s - ramp), 0.0)
    steady = t - first - last
    went = first**2 / (2 * ramp) + steady + last - last**2 / (2 * ramp)
    fine = _curve(walk.points_m, np.linspace(0.0, 1.0, 200))
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1)))
    share = went / (lasts_s - ramp) * lengths[-1]
    return np.stack([np.interp(share, lengths, fine[:, axis]) for axis in (0, 1)], axis=1)


def _curve(points_m: Floor, share: Vector) -> Floor:
    """A smooth curve through the points, at shares of its chords' length."""
    if len(points_m) == 2:
        return np.asarray(points_m[0] + share[:, None] * (points_m[1] - points_m[0]))
    chords = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points_m, axis=0), axis=1)))
    curve = CubicSpline(chords / chords[-1], points_m, bc_type="natural")
    return np.asarray(curve(share))


def _heading(walk: Walk, time_s: Vector) -> Vector:
    """Heading on a walk, and after it the last one, degrees."""
    if walk.facing_deg is not None:
        return np.full(len(time_s), walk.facing_deg)
    inside = np.clip(time_s, walk.from_s + 0.1, walk.to_s - 0.1)
    steps = _along(walk, inside + 0.02) - _along(walk, inside - 0.02)
    found: Vector = np.degrees(np.arctan2(steps[:, 0], steps[:, 1]))
    return found
