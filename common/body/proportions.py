"""Proportions of bodies: the thesis's, a standing body's, and where joints lie in its cylinders."""

from functools import lru_cache
from typing import Any, Final

import numba
import numpy as np

from common.body.body import Bdp, Elliptic, Round, Vector

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
    """The thesis's proportions at a stature: what is known of a body before it is measured.

    Args:
        stature: Height from sole to crown, in the unit that the lengths shall have.

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
"""How far a shoulder lies below the top of the trunk, in long radii of the trunk (P18)."""

SHOULDERS_APART: Final = 0.20
"""Between the joint centres of the shoulders, in statures: acromia are 0.23 apart (ANSUR II), the
centres some 15 mm a side further in."""
ELBOW_SHARE, WRIST_SHARE = 0.186 / 0.415, 0.332 / 0.415
"""Where elbow and wrist lie between the shoulder's joint centre and the tip of a straight arm. The
cylinders end where the paper cuts the silhouette (arms in halves, trunk to legs 4 : 6), joints
where bodies bend: the published landmarks lie on the cylinders at mean adult lengths (upper arm
0.186 statures, forearm 0.146, hand 0.108, of which the outer quarter is too thin to be seen)."""
HIP_SHARE, KNEE_SHARE, ANKLE_SHARE = 0.530, 0.285, 0.039
"""Heights of hip, knee and ankle above the sole, in statures."""


def body_vector(bdp: Bdp) -> Vector:
    """The body as the kernel wants it, shape (39,): 26 lengths, attachments, landmarks.

    Entries 0-25 are the BDPs in the order of LIMBS. 26-28: shoulder_x, shoulder_y, hip_x from the
    navel, in body axes, both sides alike. 29-36: how far elbow, wrist, knee and ankle lie from
    the shoulder or hip along the straight limb, right then left each. 37: how far the anatomical
    hips lie above the navel. 38: how far the joint centres of the shoulders, and with them the
    arms' landmarks, lie within the cylinders'.
    """
    return np.array(_body_numbers(bdp))


@lru_cache(maxsize=64)
def _body_numbers(bdp: Bdp) -> tuple[float, ...]:
    """The same numbers: a body hardly changes from frame to frame."""
    return tuple(attached(np.array(bdp.lengths())).tolist())


@numba.njit(cache=True)
def attached(lengths: Any) -> Any:
    """The body vector (39,) of 26 lengths."""
    body = np.empty(39)
    body[:26] = lengths
    long_radius, height = lengths[0], lengths[5] + lengths[2] + lengths[8] + lengths[14]
    inset = long_radius - SHOULDERS_APART / 2 * height
    body[26] = long_radius
    body[27] = lengths[2] - SHOULDER_DROP * long_radius
    body[28] = long_radius - lengths[6]
    for side in range(2):
        arm = lengths[19 + 2 * side] + lengths[23 + 2 * side]
        leg = lengths[8 + 3 * side] + lengths[14 + 3 * side]
        body[29 + side], body[31 + side] = ELBOW_SHARE * (inset + arm), WRIST_SHARE * (inset + arm)
        body[33 + side], body[35 + side] = leg - KNEE_SHARE * height, leg - ANKLE_SHARE * height
    body[37] = HIP_SHARE * height - (lengths[8] + lengths[14])
    body[38] = inset
    return body


def stature(bdp: Bdp) -> float:
    """Height of the standing body from sole to crown."""
    return bdp.head.height + bdp.torso.height + bdp.r_upper_leg.height + bdp.r_lower_leg.height
