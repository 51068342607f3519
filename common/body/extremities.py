"""Nose, heels, toes and knuckles: estimated from the other joints where no camera sees them.

A foot stands square to its lower leg, with the toes a little outward of where the hips face; it
lies flat where it would otherwise pass through the floor. A hand continues its forearm. The nose is
ahead of the head's axis. Lengths are shares of the stature. Source: Drillis & Contini 1966, as in
Winter, Biomechanics and Motor Control of Human Movement, fig. 4.1 (foot 0.152, ankle 0.039 above
the sole, chin 0.870, eyes 0.936); de Leva 1996 (wrist to third knuckle 0.047, mean of women and
men); ANSUR II (depth of the head 0.113); Perry & Burnfield, Gait Analysis (toes 7 degrees out).
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES

EXTREMITY_NAMES: Final = ("nose", "l_heel", "l_toe", "l_knuckle", "r_heel", "r_toe", "r_knuckle")
"""The landmarks that follow the 15 in `poses.npz`: the tip of the nose, the heels where they
bear, the tips of the big toes, the knuckles of the middle fingers."""
ALL_JOINT_NAMES: Final = JOINT_NAMES + EXTREMITY_NAMES
EXTREMITY_LINES: Final = tuple(
    (ALL_JOINT_NAMES.index(f"{side}_{start}"), ALL_JOINT_NAMES.index(f"{side}_{end}"))
    for side in "lr"
    for start, end in (("wrist", "knuckle"), ("ankle", "heel"), ("ankle", "toe"), ("heel", "toe"))
)
"""Hands and feet as line segments: indices in ALL_JOINT_NAMES of both ends of each."""

FOOT_SHARE: Final = 0.152
HEEL_OF_FOOT: Final = 0.24
"""How far the heel lies behind the ankle, as a share of the foot."""
AHEAD_SHARE, BEHIND_SHARE = (1.0 - HEEL_OF_FOOT) * FOOT_SHARE, HEEL_OF_FOOT * FOOT_SHARE
SOLE_SHARE: Final = 0.010
"""Height of heel and toe over the floor while they stand, statures: half as thick as a toe."""
DOWN_SHARE: Final = 0.039 - SOLE_SHARE
"""How far heel and toe lie below the ankle, statures."""
TOES_OUT: Final = math.tan(math.radians(7.0))
KNUCKLE_SHARE: Final = 0.047
NOSE_DOWN_SHARE, NOSE_AHEAD_SHARE = 1.0 - (0.870 + 0.936) / 2, 0.113 / 2 + 0.012
"""Height of the nose below the crown and depth ahead of the head's axis, statures. The crown is
above the middle of the head's depth; the nose protrudes by 0.012."""

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
_SIDES: Final = {
    part: [_AT[f"l_{part}"], _AT[f"r_{part}"]]
    for part in ("hip", "knee", "ankle", "elbow", "wrist")
}
_OUTER: Final = np.array([[1.0], [-1.0]])
"""The body's left is the left leg's outer side."""
Places = NDArray[np.float64]


def extremities(joints_m: Places, stature_m: float) -> Places:
    """Places (..., 7, 3) of EXTREMITY_NAMES, metres.

    Args:
        joints_m: (..., 15, 3) of JOINT_NAMES, in the world; NaN gives NaN.
        stature_m: Height from sole to crown.
    """
    hips, knees, ankles, elbows, wrists = (joints_m[..., at, :] for at in _SIDES.values())
    left = _unit(hips[..., 0, :] - hips[..., 1, :])
    nose = _nose(joints_m[..., _AT["neck"], :], joints_m[..., _AT["head_top"], :], left, stature_m)
    heels, toes = _feet(knees, ankles, left[..., None, :], stature_m)
    knuckles = wrists + KNUCKLE_SHARE * stature_m * _unit(wrists - elbows)
    limbs = np.stack([heels, toes, knuckles], axis=-2)
    sides = limbs.reshape(*limbs.shape[:-3], 6, 3)
    return np.concatenate([nose[..., None, :], sides], axis=-2)


def _nose(neck: Places, top: Places, left: Places, stature_m: float) -> Places:
    up = _unit(top - neck)
    ahead = _unit(cross(left, up))
    return top + stature_m * (NOSE_AHEAD_SHARE * ahead - NOSE_DOWN_SHARE * up)


def _feet(knees: Places, ankles: Places, left: Places, stature_m: float) -> tuple[Places, Places]:
    """Heels and toes, (..., 2, 3) each, of the left and the right leg."""
    shank = _unit(ankles - knees)
    ahead = _unit(cross(shank, left))
    outer = cross(ahead, shank) * _OUTER
    ahead = _flat(_unit(ahead + TOES_OUT * outer), ankles[..., 1] / stature_m)
    down = _unit(shank - (shank * ahead).sum(axis=-1, keepdims=True) * ahead)
    under = ankles + DOWN_SHARE * stature_m * down
    return under - BEHIND_SHARE * stature_m * ahead, under + AHEAD_SHARE * stature_m * ahead


def _flat(ahead: Places, ankle_shares: Places) -> Places:
    """Direction of a foot whose heel and toe stay above the floor.

    Args:
        ahead: (..., 3) wanted direction, unit length.
        ankle_shares: (...) height of the ankle, statures.
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
    unit: Places = along / np.maximum(np.sqrt((along**2).sum(axis=-1, keepdims=True)), 1e-9)
    return unit


def cross(a: Places, b: Places) -> Places:
    """Cross product of (..., 3); faster than np.cross for few vectors."""
    one, other = [1, 2, 0], [2, 0, 1]
    return a[..., one] * b[..., other] - a[..., other] * b[..., one]
