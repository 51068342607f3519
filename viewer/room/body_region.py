"""Where in a picture the body lies whose landmarks are known."""

from collections.abc import Iterable
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.body.proportions import BONE_SHARES

Bytes = NDArray[np.uint8]

HAND: Final = 0.5
"""How far a hand goes on beyond its wrist, in forearms."""
_AT: Final = {name: place for place, name in enumerate(JOINT_NAMES)}
_SIDES: Final = ("l", "r")
BONES: Final = tuple(
    (_AT[near], _AT[far], radius)
    for near, far, radius in (
        ("neck", "head_top", 0.055),
        ("pelvis", "neck", 0.085),
        *((f"{s}_hip", f"{s}_knee", 0.05) for s in _SIDES),
        *((f"{s}_knee", f"{s}_ankle", 0.035) for s in _SIDES),
        *((f"{s}_shoulder", f"{s}_elbow", 0.03) for s in _SIDES),
        *((f"{s}_elbow", f"{s}_wrist", 0.024) for s in _SIDES),
    )
)
"""Near and far end, and radius, in statures: about as people are."""
LONG_BONES: Final = tuple(
    (_AT[near], _AT[far], BONE_SHARES[bone])
    for near, far, bone in (
        ("pelvis", "neck", "trunk"),
        *((f"{s}_hip", f"{s}_knee", "upper_leg") for s in _SIDES),
        *((f"{s}_knee", f"{s}_ankle", "lower_leg") for s in _SIDES),
    )
)
"""Near and far end, and length in statures: the least foreshortened gives the stature."""
_TRUNK: Final = [_AT[name] for name in ("l_shoulder", "r_shoulder", "r_hip", "l_hip")]
_HANDS: Final = [(_AT[f"{s}_elbow"], _AT[f"{s}_wrist"]) for s in _SIDES]
_ANKLES: Final = [_AT[f"{s}_ankle"] for s in _SIDES]
FOOT: Final = 0.045
"""Radius of a foot about its ankle, in statures."""
HULL: Final = 3
"""Corners of the trunk that have something between them."""
FINE: Final = 3
"""Bits of a pixel that lines are drawn with."""


def shown(landmarks: Landmarks, joints: Iterable[int]) -> bool:
    """Whether none of these joints is one that may stand anywhere, unseen among others that are.

    Landmarks none of which is sure at all are a guess at a whole body.
    """
    sure = landmarks.confidence
    return not any(sure) or all(sure[joint] > 0.0 for joint in joints)


def stature_px(landmarks: Landmarks) -> float:
    """How tall the body would be upright in the picture, by its least foreshortened long bone that
    is seen; 0 where none is."""
    places = np.array(landmarks.joints_px)
    return max(
        (
            float(np.hypot(*(places[far] - places[near]))) / length
            for near, far, length in LONG_BONES
            if shown(landmarks, (near, far))
        ),
        default=0.0,
    )


def body_region(landmarks: Landmarks, shape: tuple[int, ...], beyond: float) -> Bytes:
    """(H, W) 1 on the body and so many statures around it.

    Args:
        landmarks: All that are seen are believed.
        shape: Of the picture, (H, W, ...).
        beyond: Statures.
    """
    tall_px, region = stature_px(landmarks), np.zeros(shape[:2], np.uint8)
    places = np.array(landmarks.joints_px)
    for near, far, radius in BONES:
        if shown(landmarks, (near, far)):
            _draw(region, places[near], places[far], (radius + beyond) * tall_px)
    for elbow, wrist in _HANDS:
        if shown(landmarks, (elbow, wrist)):
            beyond_wrist = places[wrist] + HAND * (places[wrist] - places[elbow])
            _draw(region, places[wrist], beyond_wrist, (0.024 + beyond) * tall_px)
    for ankle in _ANKLES:
        if shown(landmarks, (ankle,)):
            _draw(region, places[ankle], places[ankle], (FOOT + beyond) * tall_px)
    trunk = [corner for corner in _TRUNK if shown(landmarks, (corner,))]
    if len(trunk) >= HULL:
        hull = cv2.convexHull(np.round(places[trunk] * (1 << FINE)).astype(np.int32))
        cv2.fillConvexPoly(region, hull, 1, cv2.LINE_8, FINE)
    return region


def bone_region(landmarks: Landmarks, shape: tuple[int, ...], bone: int) -> Bytes:
    """(H, W) 1 on one of BONES; a forearm ends with its hand, a shank with its foot."""
    near, far, radius = BONES[bone]
    tall_px, region = stature_px(landmarks), np.zeros(shape[:2], np.uint8)
    start, end = np.array(landmarks.joints_px[near]), np.array(landmarks.joints_px[far])
    _draw(region, start, end, radius * tall_px)
    if (near, far) in _HANDS:
        _draw(region, end, end + HAND * (end - start), radius * tall_px)
    if far in _ANKLES:
        _draw(region, end, end, FOOT * tall_px)
    return region


def _draw(
    region: Bytes, start: NDArray[np.float64], end: NDArray[np.float64], radius_px: float
) -> None:
    """A capsule, its ends round."""
    near, far = (
        np.round((place - 0.5) * (1 << FINE)).astype(int).tolist() for place in (start, end)
    )
    cv2.line(region, near, far, 1, max(1, round(2 * radius_px)), cv2.LINE_8, FINE)
