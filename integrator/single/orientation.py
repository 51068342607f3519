"""Facing of a body in a single view: profile or front, left or right (T22)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.notes.notes import Orientation

PROFILE, FRONTAL = 0.65, 0.8
"""Mean breadths below which a body counts as in profile, and above which not."""
INERTIA: Final = 0.85
"""Weight of the mean breadth in its next value: half is replaced after four frames."""
FADING: Final = 0.95
"""Weight of the evidence for left and right in its next value."""
KNEES, ELBOWS, WALKING = 1.0, 0.5, 20.0
"""Evidence for the faced side from a bend of 90 degrees, and from a step of a stature."""
CONFIDENT_AT: Final = 2.0
"""Evidence that means odds of e to 1."""
UNKNOWN_FRONT: Final = 0.7
"""Confidence that a person who is not in profile faces the camera: recorded people mostly do."""

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
_PELVIS, _NECK = _AT["pelvis"], _AT["neck"]
_KNEES: Final = [[_AT[f"{s}_{j}"] for j in ("hip", "knee", "ankle")] for s in "lr"]
_ELBOWS: Final = [[_AT[f"{s}_{j}"] for j in ("shoulder", "elbow", "wrist")] for s in "lr"]


class Bearing(NamedTuple):
    """State of a body's facing."""

    orientation: Orientation = "forward_right"
    confidence: float = UNKNOWN_FRONT
    """Confidence in it, in [0, 1]."""
    breadth: float | None = None
    """Mean of the trunk's visible breadth; None: never seen."""
    to_right: float = 0.0
    """Evidence for facing the right of the picture; negative: for the left."""
    at: tuple[float, float] | None = None
    """Column of the pelvis and length of the trunk in the frame before, px."""


def faced(bearing: Bearing, joints_px: NDArray[np.float64], breadth: float) -> Bearing:
    """The state after one more frame.

    Args:
        bearing: Before it.
        joints_px: (15, 2), JOINT_NAMES, as fitted.
        breadth: Visible share of the trunk's breadth.
    """
    trunk_px = float(np.linalg.norm(joints_px[_NECK] - joints_px[_PELVIS]))
    at = (float(joints_px[_PELVIS, 0]), max(trunk_px, 1.0))
    mean = breadth if bearing.breadth is None else bearing.breadth
    mean = INERTIA * mean + (1.0 - INERTIA) * breadth
    to_right = FADING * bearing.to_right + (1.0 - FADING) * 10.0 * _bends(joints_px)
    if bearing.at is not None:
        to_right += WALKING * (at[0] - bearing.at[0]) / (3.0 * at[1])
    bearing = bearing._replace(breadth=mean, to_right=to_right, at=at)
    was_profile = bearing.orientation in ("left", "right")
    if mean < (FRONTAL if was_profile else PROFILE):
        confidence = 1.0 / (1.0 + math.exp(-abs(to_right) / CONFIDENT_AT))
        side: Orientation = "right" if to_right >= 0.0 else "left"
        return bearing._replace(orientation=side, confidence=confidence)
    if not was_profile:
        return bearing
    front: Orientation = "forward_right" if to_right >= 0.0 else "forward_left"
    return bearing._replace(orientation=front, confidence=UNKNOWN_FRONT)


def _bends(joints_px: NDArray[np.float64]) -> float:
    """Evidence from knees and elbows: knees bend backwards, elbows forwards."""
    said = 0.0
    for chains, weight in ((_KNEES, -KNEES), (_ELBOWS, ELBOWS)):
        for chain in chains:
            upper, lower = np.diff(joints_px[chain], axis=0)
            upper = upper / max(float(np.linalg.norm(upper)), 1e-9)
            lower = lower / max(float(np.linalg.norm(lower)), 1e-9)
            said += weight * float(lower[0] - (lower @ upper) * upper[0])
    return said
