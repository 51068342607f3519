"""The 15 postures as curves of joint angles (ours: the paper's list is lost, P56)."""

from collections.abc import Callable
from typing import Final

import numpy as np

from common.body.body import Vector
from synth.person.people import Style

Track = dict[str, Vector]
"""Joint angles over time by their names in ANGLES, degrees."""

Move = Callable[[Vector, Style, Track], Track]
"""Function from seconds since the motion began (n,), style and stance to the angles that differ
from the stance."""

MOTION_S: Final = 40 / 15
"""Duration of a posture."""


def smooth(x: Vector) -> Vector:
    """Smooth step from 0 to 1."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _bump(turns: Vector, centre: float, width: float) -> Vector:
    """1 at `centre`, falling on both sides; periodic."""
    off = (turns - centre + 0.5) % 1.0 - 0.5
    found: Vector = np.exp(-((off / width) ** 2))
    return found


def _held(t: Vector, s: Style) -> Vector:
    """0, rising to 1, held, back to 0: the curve of raising and squatting."""
    t = t * s.speed - 0.25
    up = smooth(np.clip(t / 0.8, 0.0, 1.0) ** s.snap)
    return up * smooth((2.1 - t) / 0.8)


def _stride(
    t: Vector, s: Style, rate_hz: float, reach_deg: float, lift_deg: float, swing_deg: float
) -> Track:
    """A walk: the forward leg bends, the arms swing opposite to the legs."""
    found: Track = {}
    for side, apart in (("l", 0.0), ("r", 0.5)):
        turns = rate_hz * s.speed * t + s.phase + apart
        ahead = np.cos(2 * np.pi * turns)
        found[f"{side}_hip_flex"] = 6.0 + s.amp * reach_deg * ahead
        found[f"{side}_knee"] = (
            6.0 + s.amp * lift_deg * _bump(turns, 0.79, 0.13) + 9.0 * _bump(turns, 0.2, 0.1)
        )
        found[f"{side}_foot"] = 0.25 * _bump(turns, 0.82, 0.1)
        found[f"{side}_sh_flex"] = 4.0 - s.swing * s.amp * swing_deg * ahead
        found[f"{side}_elbow"] = s.elbow + 11.0 * (1.0 - ahead)
    found["torso_yaw"] = 5.0 * np.cos(2 * np.pi * (rate_hz * s.speed * t + s.phase))
    return found


def walk_in_place(t: Vector, s: Style, still: Track) -> Track:
    """Knees raised alternately, the feet land in place."""
    found: Track = {}
    for side, apart in (("l", 0.0), ("r", 0.5)):
        wave = np.sin(2 * np.pi * (0.92 * s.speed * t + s.phase + apart))
        up = np.maximum(wave, 0.0) ** (0.7 + 0.5 * s.snap)
        found[f"{side}_hip_flex"] = still[f"{side}_hip_flex"] + 45.0 * s.amp * up
        found[f"{side}_knee"] = still[f"{side}_knee"] + 70.0 * s.amp * up
        found[f"{side}_foot"] = 0.6 * up**2
        found[f"{side}_sh_flex"] = 4.0 - 18.0 * s.swing * s.amp * wave
        found[f"{side}_elbow"] = s.elbow + 11.0 + 13.0 * np.maximum(-wave, 0.0)
    found["torso_yaw"] = 5.0 * np.sin(2 * np.pi * (0.92 * s.speed * t + s.phase))
    return found


def walk_sideways(t: Vector, s: Style, still: Track) -> Track:
    """Side steps to the left: the left foot goes out, the right one follows."""
    turns = 0.95 * s.speed * np.maximum(t - 0.05, 0.0)
    apart = 13.0 * s.amp * np.sin(np.pi * turns) ** 2
    found: Track = {"head_yaw": np.full_like(t, 12.0)}
    for side, start in (("l", 0.0), ("r", 0.5)):
        lift = np.maximum(np.sin(2 * np.pi * (turns - start)), 0.0)
        found[f"{side}_hip_abd"] = 2.5 + apart
        found[f"{side}_hip_flex"] = still[f"{side}_hip_flex"] + 14.0 * s.amp * lift
        found[f"{side}_knee"] = still[f"{side}_knee"] + 30.0 * s.amp * lift
        found[f"{side}_sh_abd"] = still[f"{side}_sh_abd"] + 0.6 * apart * s.swing
    return found


def walk_toward(t: Vector, s: Style, _still: Track) -> Track:
    """Ordinary steps towards camera 1."""
    return _stride(t, s, 0.9, 17.0, 44.0, 16.0)


def walk_slow_bigswing(t: Vector, s: Style, _still: Track) -> Track:
    """Slow steps with arms that swing far."""
    return _stride(t, s, 0.6, 13.5, 44.0, 46.0)


def raise_lateral(*sides: str, height: str) -> Move:
    """Arms up sideways, held, and down; `height` names the style's number."""

    def move(t: Vector, s: Style, still: Track) -> Track:
        up, found = _held(t, s), {}
        for side in sides:
            low = still[f"{side}_sh_abd"]
            found[f"{side}_sh_abd"] = low + (getattr(s, height) - low) * up
            found[f"{side}_sh_twist"] = -12.0 * (1.0 - up)
            found[f"{side}_elbow"] = s.elbow * (1.0 - 0.55 * up)
        return found

    return move


def raise_both_forward_up(t: Vector, s: Style, still: Track) -> Track:
    """Both arms up before the body until they point at the ceiling."""
    up, found = _held(t, s), {}
    for side in "lr":
        found[f"{side}_sh_flex"] = 4.0 + (s.over - 4.0) * up
        found[f"{side}_sh_abd"] = still[f"{side}_sh_abd"] - s.cross * up
        found[f"{side}_elbow"] = s.elbow * (1.0 - 0.5 * up)
    return found


def swing_right_circles(t: Vector, s: Style, _still: Track) -> Track:
    """The right arm in circles beside the body, forwards and up first."""
    round_deg = 365.0 * s.speed * np.maximum(t - 0.05, 0.0)
    wave = np.sin(np.radians(round_deg))
    end_deg = 365.0 * s.speed * MOTION_S
    # it ends as it began: the last turn is completed, so easing out does not unwind the circles
    round_deg = round_deg * round(end_deg / 360.0) * 360.0 / end_deg
    return {
        "r_sh_flex": 4.0 + round_deg,
        "r_sh_abd": s.carry + 9.0 + 8.0 * s.amp * np.cos(2 * np.radians(round_deg)),
        "r_elbow": np.full_like(t, 0.5 * s.elbow),
        "torso_yaw": 5.5 * s.amp * wave,
        "l_sh_flex": 4.0 + 6.0 * wave,
    }


def swing_both_backforth(t: Vector, s: Style, still: Track) -> Track:
    """Both arms forwards and back together."""
    wave = np.sin(2 * np.pi * 0.98 * s.speed * t)
    found: Track = {}
    for side in "lr":
        found[f"{side}_sh_flex"] = 17.0 + 52.0 * s.amp * s.swing * wave
        found[f"{side}_sh_abd"] = still[f"{side}_sh_abd"] - 0.5 * s.cross
        found[f"{side}_elbow"] = s.elbow + 10.0 * np.maximum(wave, 0.0)
    found["torso_pitch"] = still["torso_pitch"] + 2.0 * wave
    return found


def swing_both_overhead_wave(t: Vector, s: Style, still: Track) -> Track:
    """Both arms over the head, waving in and out."""
    up = smooth(t * s.speed / 0.6) * smooth((MOTION_S - t) / 0.4)
    wave = np.sin(2 * np.pi * 1.55 * s.speed * (t - 0.45))
    found: Track = {}
    for side in "lr":
        low = still[f"{side}_sh_abd"]
        found[f"{side}_sh_abd"] = low + up * (s.over - 13.0 + 16.0 * s.amp * wave - low)
        found[f"{side}_sh_twist"] = -12.0 + 92.0 * up
        found[f"{side}_elbow"] = s.elbow + up * (20.0 - s.elbow + 14.0 * s.amp * wave)
    return found


def squat(arms_deg: float, elbow_deg: float, deep: float) -> Move:
    """Down with bent knees, held, and up; the arms rise by `arms_deg`."""

    def move(t: Vector, s: Style, still: Track) -> Track:
        down = _held(t, s)
        bend, found = deep * s.amp * down, {}
        for side in "lr":
            found[f"{side}_hip_flex"] = still[f"{side}_hip_flex"] + 84.0 * bend
            found[f"{side}_knee"] = still[f"{side}_knee"] + 101.0 * bend
            found[f"{side}_hip_abd"] = still[f"{side}_hip_abd"] + 9.0 * bend
            found[f"{side}_hip_twist"] = still[f"{side}_hip_twist"] + 8.0 * bend
            found[f"{side}_sh_flex"] = 4.0 + arms_deg * down
            found[f"{side}_elbow"] = s.elbow + (elbow_deg - s.elbow) * down
        found["root_pitch"] = 19.0 * bend
        found["torso_pitch"] = still["torso_pitch"] + 14.0 * bend
        found["head_pitch"] = still["head_pitch"] - 18.0 * bend
        return found

    return move


def kick_right_forward(t: Vector, s: Style, still: Track) -> Track:
    """Two kicks forwards: the bent leg comes up and stretches at the top."""
    turns = 0.78 * s.speed * np.maximum(t - 0.05, 0.0)
    up, bent = _bump(turns, 0.36, 0.2), _bump(turns, 0.22, 0.1)
    return {
        "r_hip_flex": still["r_hip_flex"] + 72.0 * s.amp * up,
        "r_knee": still["r_knee"] + 66.0 * s.amp * bent + 16.0 * _bump(turns, 0.6, 0.1),
        "r_foot": up,
        "l_sh_flex": 4.0 + 27.0 * s.swing * up,
        "r_sh_flex": 4.0 - 23.0 * s.swing * up,
        "l_elbow": s.elbow + 20.0 * up,
        "root_pitch": -8.5 * s.amp * up,
    }


def kick_left_side(t: Vector, s: Style, still: Track) -> Track:
    """Two kicks to the left, the trunk leaning the other way."""
    turns = 0.78 * s.speed * np.maximum(t - 0.05, 0.0)
    up, bent = _bump(turns, 0.42, 0.2), _bump(turns, 0.2, 0.11)
    return {
        "l_hip_abd": still["l_hip_abd"] + 50.0 * s.amp * up,
        "l_knee": still["l_knee"] + 36.0 * s.amp * bent,
        "l_hip_flex": still["l_hip_flex"] + 16.0 * bent,
        "l_foot": up,
        "r_hip_abd": still["r_hip_abd"] + 3.0 * up,
        "root_roll": 12.5 * s.amp * up,
        "r_sh_abd": still["r_sh_abd"] + 33.0 * s.swing * up,
        "l_sh_abd": still["l_sh_abd"] + 17.0 * s.swing * up,
        "r_elbow": s.elbow + 14.0 * up,
    }


MOVES: Final[dict[str, Move]] = {
    "walk_in_place": walk_in_place,
    "walk_sideways": walk_sideways,
    "walk_toward": walk_toward,
    "walk_slow_bigswing": walk_slow_bigswing,
    "raise_right_lateral": raise_lateral("r", height="raise_to"),
    "raise_left_lateral": raise_lateral("l", height="raise_to"),
    "raise_both_lateral": raise_lateral("l", "r", height="both_to"),
    "raise_both_forward_up": raise_both_forward_up,
    "swing_right_circles": swing_right_circles,
    "swing_both_backforth": swing_both_backforth,
    "swing_both_overhead_wave": swing_both_overhead_wave,
    "squat": squat(arms_deg=18.0, elbow_deg=36.0, deep=1.0),
    "squat_arms_forward": squat(arms_deg=84.0, elbow_deg=7.0, deep=0.93),
    "kick_right_forward": kick_right_forward,
    "kick_left_side": kick_left_side,
}
