"""What arms do when two people meet: an embrace, a thing handed over."""

import numpy as np

from common.body.body import Vector
from synth.motion.moves import Move, Track, smooth
from synth.person.people import Style


def _held(t: Vector, lasts_s: float) -> Vector:
    """0, rising to 1 within 0.6 s, held, back to 0 at the end."""
    return np.asarray(smooth(t / 0.6) * smooth((lasts_s - t) / 0.6))


def embrace(lasts_s: float, high: str) -> Move:
    """Both arms around somebody right before the body; the arm of side `high` lies over a
    shoulder."""

    def move(t: Vector, _style: Style, still: Track) -> Track:
        up, found = _held(t, lasts_s), {}
        for side in "lr":
            flex = 78.0 if side == high else 48.0
            for name, value in (("sh_flex", flex), ("sh_abd", 20.0), ("sh_twist", -75.0)):
                key = f"{side}_{name}"
                found[key] = still[key] + up * (value - still[key])
            found[f"{side}_elbow"] = still[f"{side}_elbow"] + up * (62.0 - still[f"{side}_elbow"])
        found["torso_pitch"] = still["torso_pitch"] + 4.0 * up
        found["head_yaw"] = still["head_yaw"] + (24.0 if high == "l" else -24.0) * up
        return found

    return move


def handing(lasts_s: float) -> Move:
    """The right hand reaches forward, and comes back."""

    def move(t: Vector, _style: Style, still: Track) -> Track:
        up, found = _held(t, lasts_s), {}
        for name, value in (("sh_flex", 66.0), ("sh_abd", 2.0), ("elbow", 24.0)):
            key = f"r_{name}"
            found[key] = still[key] + up * (value - still[key])
        found["torso_yaw"] = still["torso_yaw"] + 10.0 * up
        found["head_pitch"] = still["head_pitch"] + 10.0 * up
        return found

    return move
