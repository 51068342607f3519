"""Our 15 joints, and which way the person faces, out of the 17 points that pose estimators give."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, lean_deg
from viewer.landmarks.keypoint_layouts import POINT

Floats = NDArray[np.float64]

NECK_SHARES: Final = (0.04, 0.18)
"""How the neck lies from the middle of the shoulders: shares of the ways from the pelvis to there,
and from there to the middle of the ears."""
TOP_SHARES: Final = (0.10, 0.26, -0.35)
"""How the top of the head lies from the middle of the ears: the same two shares, and that of the
way from there to the nose."""
NOSE_WEIGHT: Final = 8.0
"""Weight of the nose in the facing: it stands out of the head by an eighth of what shoulders
and hips together are wide."""

_PAIRS: Final = {
    "pelvis": ("l_hip", "r_hip"),
    "neck": ("l_shoulder", "r_shoulder"),
    "head_top": ("l_ear", "r_ear"),
}
"""Joints that lie at or near the middle of two points."""


def fifteen(points: Floats) -> Floats:
    """Where the joints of JOINT_NAMES are, (15, 2), given the points of BODY_POINTS, (17, 2)."""
    hips, shoulders, ears = (_middle(points, *pair) for pair in _PAIRS.values())
    up, neck, ahead = shoulders - hips, ears - shoulders, points[POINT["nose"]] - ears
    trunk = {
        "pelvis": hips,
        "neck": shoulders + NECK_SHARES[0] * up + NECK_SHARES[1] * neck,
        "head_top": ears + TOP_SHARES[0] * up + TOP_SHARES[1] * neck + TOP_SHARES[2] * ahead,
    }
    return np.array([trunk[n] if n in trunk else points[POINT[n]] for n in JOINT_NAMES])


def fifteen_shares(shares: Floats) -> Floats:
    """The same of numbers that say how well points are seen, (17,): the worse of a pair counts."""
    pairs = {
        name: min(shares[POINT[one]], shares[POINT[other]]) for name, (one, other) in _PAIRS.items()
    }
    return np.array([pairs[n] if n in pairs else shares[POINT[n]] for n in JOINT_NAMES])


def facing_deg(points: Floats) -> float:
    """Which way the person of these points faces; see `Landmarks.facing_deg`.

    Who faces the camera has the left shoulder and hip on the right of the picture; whose nose is on
    the right of the ears faces the right of the picture.
    """
    hips, shoulders = (_middle(points, *_PAIRS[name]) for name in ("pelvis", "neck"))
    lean = math.radians(lean_deg(*(shoulders - hips).tolist()))
    upright = points @ np.array([math.cos(lean), math.sin(lean)])
    across = sum(
        upright[POINT[f"l_{name}"]] - upright[POINT[f"r_{name}"]] for name in ("shoulder", "hip")
    )
    ahead = upright[POINT["nose"]] - (upright[POINT["l_ear"]] + upright[POINT["r_ear"]]) / 2
    return math.degrees(math.atan2(NOSE_WEIGHT * ahead, across))


def _middle(points: Floats, one: str, other: str) -> Floats:
    return (points[POINT[one]] + points[POINT[other]]) / 2
