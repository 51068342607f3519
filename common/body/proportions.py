"""Proportions of bodies: the thesis's, a standing body's, and where joints lie in its cylinders."""

from functools import lru_cache
from typing import Final

import numpy as np

from common.body.body import Bdp, Elliptic, Floats, Round, Vector
from common.compiled import compiled

THESIS_RATIOS: Final = {
    "stature": 175.0,
    "head": 25.0,
    "torso": 52.0,
    "upper_arm": 25.0,
    "lower_arm": 35.0,
    "upper_leg": 46.0,
    "lower_leg": 52.0,
}
"""Lengths of the model of Demir 2006, table 3.1 (T4)."""

THESIS_DIAMETERS: Final = {
    "head": 20.0,
    "torso": 40.0,
    "upper_arm": 10.0,
    "lower_arm": 10.0,
    "upper_leg": 20.0,
    "lower_leg": 20.0,
}
"""Widths of the model of Demir 2006, table 3.2, whose "radii" are diameters (T5, M18)."""

TORSO_DEPTH_SHARE: Final = 0.6
"""Depth of a trunk over its width: an assumption, the documents give none (M10)."""


def thesis_bdp(stature: float) -> Bdp:
    """The thesis's proportions scaled to a stature: the body model before any measurement.

    Args:
        stature: Height from sole to crown, in the unit wanted for the lengths.

    Source: Demir 2006, tables 3.1 and 3.2 (T4, T5, M18); trunk depth: TORSO_DEPTH_SHARE.
    """
    unit = stature / THESIS_RATIOS["stature"]

    def elliptic(name: str, depth_share: float) -> Elliptic:
        radius = THESIS_DIAMETERS[name] / 2 * unit
        return Elliptic(radius, radius * depth_share, THESIS_RATIOS[name] * unit)

    def round_(name: str) -> Round:
        return Round(THESIS_DIAMETERS[name] / 2 * unit, THESIS_RATIOS[name] * unit)

    upper_leg, lower_leg = elliptic("upper_leg", 1.0), elliptic("lower_leg", 1.0)
    upper_arm, lower_arm = round_("upper_arm"), round_("lower_arm")
    return Bdp(
        torso=elliptic("torso", TORSO_DEPTH_SHARE),
        head=elliptic("head", 1.0),
        r_upper_leg=upper_leg,
        l_upper_leg=upper_leg,
        r_lower_leg=lower_leg,
        l_lower_leg=lower_leg,
        r_upper_arm=upper_arm,
        l_upper_arm=upper_arm,
        r_lower_arm=lower_arm,
        l_lower_arm=lower_arm,
    )


SHOULDER_DROP: Final = 0.45
"""Depth of a shoulder below the top of the trunk, in long radii of the trunk (P18)."""

SHOULDERS_APART: Final = 0.20
"""Distance between the shoulders' joint centres, statures: acromia are 0.23 apart (ANSUR II),
the centres some 15 mm further in on each side."""
ELBOW_SHARE, WRIST_SHARE = 0.186 / 0.415, 0.332 / 0.415
"""Where elbow and wrist lie between the shoulder's joint centre and the tip of a straight arm,
as shares. The cylinders end where the paper cuts the silhouette (arms in halves, trunk to legs 4
: 6); joints lie where bodies bend. So the published landmarks lie on the cylinders at mean adult
lengths (upper arm 0.186 statures, forearm 0.146, hand 0.108, of which the outer quarter is too
thin to be seen)."""
BONE_SHARES: Final = {
    "trunk": 0.322,
    "head": 0.137,
    "upper_arm": 0.154,
    "lower_arm": 0.141,
    "upper_leg": 0.244,
    "lower_leg": 0.249,
    "shoulders": 0.203,
    "hips": 0.092,
}
"""Lengths between joints as landmarks show them, statures: the trunk from pelvis to neck, the
head from neck to crown, shoulders and hips from side to side."""
HIP_SHARE, KNEE_SHARE, ANKLE_SHARE = 0.530, 0.285, 0.039
"""Heights of hip, knee and ankle above the sole, in statures."""


PER_ELLIPTIC, PER_ROUND = 3, 2
"""Number of lengths of a cylinder: two radii and a height, or an arm's radius and height."""
LENGTHS: Final = 26
"""Number of lengths at the start of a body vector: the BDPs in the order of LIMBS. The indices
below are those of the right limb."""
TORSO_RADIUS, TORSO_HEIGHT, HEAD_HEIGHT = 0, 2, 5
UPPER_LEG_RADIUS, UPPER_LEG_HEIGHT, LOWER_LEG_HEIGHT = 6, 8, 14
ARMS: Final = 18
"""Index of the arms' lengths; the first is a radius."""
UPPER_ARM_HEIGHT, LOWER_ARM_HEIGHT = 19, 23
SHOULDER_ASIDE, SHOULDER_UP, HIP_ASIDE = 26, 27, 28
"""Indices of the places of shoulder and hip relative to the navel, in body axes, both sides
alike."""
ELBOW_ALONG, WRIST_ALONG, KNEE_ALONG, ANKLE_ALONG = 29, 31, 33, 35
"""Indices of the distances of elbow, wrist, knee and ankle from the shoulder or hip along the
straight limb, right then left."""
HIPS_UP: Final = 37
"""Index of the height of the anatomical hips above the navel."""
SHOULDER_INSET: Final = 38
"""Index of the distance by which the shoulders' joint centres, and the arms' landmarks with
them, lie inside the cylinders' shoulders."""
BODY: Final = 39
"""Length of a body vector."""


def body_vector(bdp: Bdp) -> Vector:
    """The body as the kernel reads it, (BODY,): lengths, where limbs hang, where joints lie."""
    return np.array(_body_numbers(bdp))


@lru_cache(maxsize=64)
def _body_numbers(bdp: Bdp) -> tuple[float, ...]:
    """The same array, cached: a body hardly changes from frame to frame."""
    return tuple(attached(np.array(bdp.lengths())).tolist())


@compiled
def attached(lengths: Vector) -> Floats:
    """The body vector (BODY,) for its LENGTHS lengths."""
    body = np.empty(BODY)
    body[:LENGTHS] = lengths
    radius, leg = lengths[TORSO_RADIUS], lengths[UPPER_LEG_HEIGHT] + lengths[LOWER_LEG_HEIGHT]
    height = (
        lengths[HEAD_HEIGHT]
        + lengths[TORSO_HEIGHT]
        + lengths[UPPER_LEG_HEIGHT]
        + lengths[LOWER_LEG_HEIGHT]
    )
    inset = radius - SHOULDERS_APART / 2 * height
    body[SHOULDER_ASIDE] = radius
    body[SHOULDER_UP] = lengths[TORSO_HEIGHT] - SHOULDER_DROP * radius
    body[HIP_ASIDE] = radius - lengths[UPPER_LEG_RADIUS]
    body[HIPS_UP] = HIP_SHARE * height - leg
    body[SHOULDER_INSET] = inset
    for side in range(2):
        at = PER_ROUND * side
        arm = lengths[UPPER_ARM_HEIGHT + at] + lengths[LOWER_ARM_HEIGHT + at]
        body[ELBOW_ALONG + side] = ELBOW_SHARE * (inset + arm)
        body[WRIST_ALONG + side] = WRIST_SHARE * (inset + arm)
        at = PER_ELLIPTIC * side
        leg = lengths[UPPER_LEG_HEIGHT + at] + lengths[LOWER_LEG_HEIGHT + at]
        body[KNEE_ALONG + side] = leg - KNEE_SHARE * height
        body[ANKLE_ALONG + side] = leg - ANKLE_SHARE * height
    return body


def stature(bdp: Bdp) -> float:
    """Height of the standing body from sole to crown."""
    return bdp.head.height + bdp.torso.height + bdp.r_upper_leg.height + bdp.r_lower_leg.height
