"""Nose, heels, toes and knuckles: where they are if nobody sees them, by the rest of the body.

A foot stands square to its lower leg, toes a little out from where the hips face, and lies flat
where it would else pass through the floor; a hand goes on along its forearm; the nose is ahead of
the head's axis. Lengths are shares of the stature. Source: Drillis & Contini 1966, as in Winter,
Biomechanics and Motor Control of Human Movement, fig. 4.1 (foot 0.152, ankle 0.039 above the sole,
chin 0.870, eyes 0.936); de Leva 1996 (wrist to third knuckle 0.047, mean of women and men); ANSUR
II (depth of the head 0.113); Perry & Burnfield, Gait Analysis (toes 7 degrees out).
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES

EXTREMITY_NAMES: Final = ("nose", "l_heel", "l_toe", "l_knuckle", "r_heel", "r_toe", "r_knuckle")
"""The landmarks that follow the 15 in `poses.npz`: the nose's tip, where heels bear, the tips of
the big toes, the knuckles of the middle fingers."""
ALL_JOINT_NAMES: Final = JOINT_NAMES + EXTREMITY_NAMES

FOOT_SHARE: Final = 0.152
HEEL_OF_FOOT: Final = 0.24
"""How far the heel lies behind the ankle, as a share of the foot."""
AHEAD_SHARE, BEHIND_SHARE = (1.0 - HEEL_OF_FOOT) * FOOT_SHARE, HEEL_OF_FOOT * FOOT_SHARE
SOLE_SHARE: Final = 0.010
"""So high are heel and toe while they stand: half as thick as a toe."""
DOWN_SHARE: Final = 0.039 - SOLE_SHARE
"""How far both lie below the ankle."""
TOES_OUT: Final = math.tan(math.radians(7.0))
KNUCKLE_SHARE: Final = 0.047
NOSE_DOWN_SHARE, NOSE_AHEAD_SHARE = 1.0 - (0.870 + 0.936) / 2, 0.113 / 2 + 0.012
"""From the top of the head, which is above the middle of its depth; a nose stands out by 0.012."""

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
Places = NDArray[np.float64]


def extremities(joints_m: Places, stature_m: float) -> Places:
    """Places (..., 7, 3) of EXTREMITY_NAMES, metres.

    Args:
        joints_m: (..., 15, 3) of JOINT_NAMES, in the world; where they are NaN, so are these.
        stature_m: From sole to crown.
    """
    at = {name: joints_m[..., i, :] for name, i in _AT.items()}
    left = _unit(at["l_hip"] - at["r_hip"])
    found = [_nose(at["neck"], at["head_top"], left, stature_m)]
    for side, sign in (("l", 1.0), ("r", -1.0)):
        ankle, wrist = at[f"{side}_ankle"], at[f"{side}_wrist"]
        found += _foot(at[f"{side}_knee"], ankle, (left, sign), stature_m)
        along = _unit(wrist - at[f"{side}_elbow"])
        found.append(wrist + KNUCKLE_SHARE * stature_m * along)
    return np.stack(found, axis=-2)


def _nose(neck: Places, top: Places, left: Places, stature_m: float) -> Places:
    up = _unit(top - neck)
    ahead = _unit(np.cross(left, up))
    return top + stature_m * (NOSE_AHEAD_SHARE * ahead - NOSE_DOWN_SHARE * up)


def _foot(knee: Places, ankle: Places, out: tuple[Places, float], stature_m: float) -> list[Places]:
    """Heel and toe; `out` is the body's left and the sign that makes it the leg's outer side."""
    shank, (left, sign) = _unit(ankle - knee), out
    ahead = _unit(np.cross(shank, left))
    outer = np.cross(ahead, shank) * sign
    ahead = _flat(_unit(ahead + TOES_OUT * outer), ankle[..., 1] / stature_m)
    down = _unit(shank - (shank * ahead).sum(axis=-1, keepdims=True) * ahead)
    under = ankle + DOWN_SHARE * stature_m * down
    return [
        under - BEHIND_SHARE * stature_m * ahead,
        under + AHEAD_SHARE * stature_m * ahead,
    ]


def _flat(ahead: Places, ankle_shares: Places) -> Places:
    """Where a foot points whose heel and toe stay above the floor.

    Args:
        ahead: (..., 3) unit length.
        ankle_shares: (...) height of the ankle in statures.
    """
    room = ankle_shares - SOLE_SHARE
    toe, heel = math.hypot(AHEAD_SHARE, DOWN_SHARE), math.hypot(BEHIND_SHARE, DOWN_SHARE)
    with np.errstate(invalid="ignore"):
        lowest = math.atan2(DOWN_SHARE, AHEAD_SHARE) - np.arcsin(np.clip(room / toe, -1.0, 1.0))
        highest = np.arcsin(np.clip(room / heel, -1.0, 1.0)) - math.atan2(DOWN_SHARE, BEHIND_SHARE)
        lowest = np.where(room >= toe, -np.inf, np.minimum(lowest, 0.0))
        highest = np.where(room >= heel, np.inf, np.maximum(highest, 0.0))
        pitch = np.clip(np.arcsin(np.clip(ahead[..., 1], -1.0, 1.0)), lowest, highest)[..., None]
    level = _unit(ahead * (1.0, 0.0, 1.0))
    found: Places = np.cos(pitch) * level + np.sin(pitch) * (0.0, 1.0, 0.0)
    return found


def _unit(along: Places) -> Places:
    unit: Places = along / np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-9)
    return unit
