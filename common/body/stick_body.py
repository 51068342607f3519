"""The stick body of one view: ten segments in the picture, their proportions, and their joints."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, Floats, Vector
from common.body.proportions import THESIS_DIAMETERS, THESIS_RATIOS
from common.compiled import compiled

SIDES: Final = ("r", "l")
"""LIMBS names; r is on the left of the picture, as a person's right who faces the camera (T10)."""

X, Y, STATURE, BREADTH, ANGLE, RATIO, GIRTH = 0, 1, 2, 3, 4, 14, 24
"""A stick pose: pelvis (px, rows down), stature (px), apparent over frontal breadth of the
trunk. Then for each of LIMBS an angle (degrees, 0 to the right, 90 up, as in table 3.3) and a
foreshortening ratio. Last the thickness of clothed limbs over that of the proportions."""
POSE_SIZE: Final = 25

TORSO, HEAD, SHOULDER_LINE, HIP_LINE = 0, 1, 10, 11
"""Indices of the segments that others hang on; two lines, shoulders and hips, follow the ten
limbs."""
CHAINS: Final = ((6, 8), (7, 9), (2, 4), (3, 5))
"""Upper and lower limb: both arms, both legs, r before l."""

HALF_SHOULDERS, SHOULDERS_BELOW, HALF_HIPS = 10, 11, 12
_L_SHOULDER, _R_SHOULDER = (JOINT_NAMES.index(f"{side}_shoulder") for side in "lr")


class Stickman(NamedTuple):
    """Proportions, in statures."""

    lengths: Vector
    """(13,): lengths of LIMBS; then half the shoulders, their depth below the neck, half the
    hips."""
    parts: Vector
    """(n, 6): segment, the shares of it at which the part begins and ends, both radii, kind
    (FLAT ..)."""
    depth: float
    """Depth of the trunk over its breadth."""


FLAT, ROUND, FLAT_WIDE, ROUND_WIDE = 0.0, 1.0, 2.0, 3.0
"""Kinds of part: flat or round ends; wide parts get narrower as the trunk turns."""


def _thesis() -> Stickman:
    """Tables 3.1 and 3.2 (T4, T5, M18); limbs hang inside the corners of the trunk."""
    unit = 1.0 / THESIS_RATIOS["stature"]
    kinds = [limb if limb in ("torso", "head") else limb[2:] for limb in LIMBS]
    radii = [0.5 * unit * THESIS_DIAMETERS[kind] for kind in kinds]
    arm, leg, trunk = radii[6], radii[2], radii[0]
    lengths = [unit * THESIS_RATIOS[kind] for kind in kinds] + [trunk - arm, arm, trunk - leg]
    parts = [[i, 0.0, 1.0, r, r, FLAT_WIDE if i == TORSO else FLAT] for i, r in enumerate(radii)]
    return Stickman(np.array(lengths), np.array(parts), 0.6)


def _adult() -> Stickman:
    """Joints at anatomical places; parts shaped as clothed silhouettes are.

    Lengths and radii were measured on two people (docs/measurements.md).
    """
    upper_arm, forearm, thigh, shin = 0.157, 0.140, 0.252, 0.240
    lengths = [0.322, 0.143, thigh, thigh, shin, shin, upper_arm, upper_arm, forearm, forearm]
    parts = [
        [TORSO, 0.06, 0.66, 0.092, 0.105, ROUND_WIDE],
        [SHOULDER_LINE, 0.0, 1.0, 0.028, 0.028, ROUND],
        [TORSO, 0.70, 1.15, 0.037, 0.031, ROUND],
        [HEAD, 0.50, 0.73, 0.047, 0.045, ROUND],
    ]
    for upper, lower in CHAINS[:2]:
        parts.append([upper, 0.0, 0.9, 0.031, 0.025, ROUND])
        parts.append([lower, 0.0, 1.55, 0.026, 0.020, ROUND])
    for upper, lower in CHAINS[2:]:
        parts.append([upper, 0.0, 0.85, 0.062, 0.043, ROUND])
        parts.append([lower, 0.0, 1.15, 0.039, 0.035, ROUND])
    return Stickman(np.array([*lengths, 0.098, 0.031, 0.060]), np.array(parts), 0.65)


THESIS: Final = _thesis()
ADULT: Final = _adult()


@compiled
def place_segments(lengths: Vector, pose: Vector, ends: Floats) -> None:
    """Both ends of every segment in the picture.

    Args:
        lengths: (13,) of a Stickman.
        pose: (POSE_SIZE,).
        ends: (12, 4), written: x and y of the near end and of the far end, px.
    """
    size = pose[STATURE]
    angle = np.radians(pose[ANGLE])
    ux, uy = np.cos(angle), -np.sin(angle)
    trunk = lengths[TORSO] * pose[RATIO] * size
    neck_x, neck_y = pose[X] + trunk * ux, pose[Y] + trunk * uy
    _set(ends, TORSO, pose[X], pose[Y], neck_x, neck_y)
    _hang(ends, HEAD, neck_x, neck_y, lengths, pose)
    drop = lengths[SHOULDERS_BELOW] * pose[RATIO] * size
    base_x, base_y = neck_x - drop * ux, neck_y - drop * uy
    half = lengths[HALF_SHOULDERS] * pose[BREADTH] * size
    _set(
        ends,
        SHOULDER_LINE,
        base_x + half * uy,
        base_y - half * ux,
        base_x - half * uy,
        base_y + half * ux,
    )
    half = lengths[HALF_HIPS] * pose[BREADTH] * size
    _set(
        ends,
        HIP_LINE,
        pose[X] + half * uy,
        pose[Y] - half * ux,
        pose[X] - half * uy,
        pose[Y] + half * ux,
    )
    for side in range(2):
        place_chain(6 + side, lengths, pose, ends)
        place_chain(2 + side, lengths, pose, ends)


@compiled
def place_chain(upper: int, lengths: Vector, pose: Vector, ends: Floats) -> None:
    """The same for one upper limb and its lower limb; the trunk's ends must be there already."""
    line, side = (SHOULDER_LINE, upper - 6) if upper >= 6 else (HIP_LINE, upper - 2)
    _hang(ends, upper, ends[line, 2 * side], ends[line, 2 * side + 1], lengths, pose)
    _hang(ends, upper + 2, ends[upper, 2], ends[upper, 3], lengths, pose)


@compiled
def _hang(ends: Floats, limb: int, x: float, y: float, lengths: Vector, pose: Vector) -> None:
    reach = lengths[limb] * pose[RATIO + limb] * pose[STATURE]
    angle = np.radians(pose[ANGLE + limb])
    _set(ends, limb, x, y, x + reach * np.cos(angle), y - reach * np.sin(angle))


@compiled
def _set(ends: Floats, row: int, ax: float, ay: float, bx: float, by: float) -> None:
    ends[row, 0], ends[row, 1], ends[row, 2], ends[row, 3] = ax, ay, bx, by


def standing(x_px: float, pelvis_y_px: float, stature_px: float) -> Vector:
    """A stick pose that stands with hanging arms."""
    pose = np.ones(POSE_SIZE)
    pose[[X, Y, STATURE]] = x_px, pelvis_y_px, stature_px
    pose[ANGLE : ANGLE + 2] = 90.0
    pose[ANGLE + 2 : ANGLE + 10] = 270.0
    return pose


def pose_of(man: Stickman, joints: NDArray[np.float64], stature_px: float) -> Vector:
    """The stick pose, (POSE_SIZE,), for joints as `joints_px` returns them, limbs of usual girth.

    Args:
        man: The body's proportions.
        joints: (15, 2) px, JOINT_NAMES, r on the left of the picture.
        stature_px: Height that the body would have standing upright, pixels.
    """
    pose = np.ones(POSE_SIZE)
    pose[[X, Y, STATURE]] = *joints[0], stature_px
    along = joints[LIMB_ENDS[:, 1]] - joints[LIMB_ENDS[:, 0]]
    pose[ANGLE:RATIO] = np.degrees(np.arctan2(-along[:, 1], along[:, 0])) % 360.0
    lengths_px = man.lengths * stature_px
    pose[RATIO:GIRTH] = np.minimum(1.0, np.hypot(*along.T) / lengths_px[: len(LIMBS)])
    across_px = np.hypot(*(joints[_L_SHOULDER] - joints[_R_SHOULDER]))
    pose[BREADTH] = min(1.0, across_px / (2.0 * lengths_px[HALF_SHOULDERS]))
    return pose


def segments_px(man: Stickman, pose: Vector) -> NDArray[np.float64]:
    """Both ends of every segment, (12, 2, 2) px."""
    ends = np.empty((12, 4))
    place_segments(man.lengths, pose, ends)
    return ends.reshape(12, 2, 2)


def joints_px(man: Stickman, pose: Vector) -> NDArray[np.float64]:
    """The 15 joints of JOINT_NAMES in the picture, (15, 2) px."""
    ends = segments_px(man, pose)
    rows = [ends[TORSO, 0], ends[TORSO, 1], ends[HEAD, 1]]
    for side in (1, 0):
        rows += [ends[6 + side, 0], ends[6 + side, 1], ends[8 + side, 1]]
        rows += [ends[2 + side, 0], ends[2 + side, 1], ends[4 + side, 1]]
    return np.array(rows)
