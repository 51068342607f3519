"""Other bodies with the same silhouette: seen from behind, or with a limb that leans the other
way."""

import math
from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, OTHER_SIDE
from common.notes.notes import ORIENTATIONS, Orientation
from common.rig.camera import Camera, arrays_of, centre
from integrator.landmarks import front_back_flip
from integrator.landmarks.landmark_rays import AT

Joints = NDArray[np.float64]
SIDEWAYS_DEG: Final = 20.0
"""Angle from a right angle, degrees, up to which a person counts as seen from the side."""
ANEW_HZ, ANEW_ASIDE_HZ = 0.05, 5.0
"""Rate at which front or back is decided again, Hz: for a person seen from front or back, and
for one seen from the side, as people turn through their side."""
SHOWN_HZ: Final = 9.0
"""Number of independent observations per second of pictures. Of synthetic people in free motion
4.9 % of the proposals have front for back. This value leaves 3.0 %, a sixth of it 2.8 and half
of it 3.1. It is not smaller because recorded people wear clothes that the training data lack."""
CERTAIN: Final = 20.0
"""Bound of the log odds from any stretch of time."""
PROPOSED_HZ: Final = 1.0
"""Log odds per second from proposals."""
SUREST: Final = 0.97
"""Bound of a picture's confidence."""
FACES: Final = 0.8
"""Confidence of a facing from which a picture distinguishes left from right: more than 90
degrees off are 0.05 % of synthetic people's in free motion, none of two performers'
(docs/measurements.md)."""
NEARLY_DEG: Final = 40.0
"""Tolerance of a proposal's facing outside the sector that the user named, degrees."""
PELVIS: Final = JOINT_NAMES.index("pelvis")
_HANGS: Final = [
    [int(LIMB_ENDS[part, 1]) for part in ((limb, limb + 2) if limb in (2, 3, 6, 7) else (limb,))]
    for limb in range(len(LIMBS))
]
"""The joints that move with the far end of each of LIMBS: a lower limb follows its upper one."""


class Front(NamedTuple):
    """Memory of front and back, which one silhouette hardly shows (L4)."""

    away: float = 0.45
    """Probability that the person faces away from the camera: recorded people mostly do not at
    first."""


def yaw_deg(camera: Camera, joints_m: Joints) -> float:
    """Direction of the lines across shoulders and hips: 0 the camera, 90 the picture's right."""
    return front_back_flip.yaw_deg(arrays_of(camera).R, joints_m[AT])


def faces(yaw: float) -> Orientation:
    """One of the six orientations for a direction (T22)."""
    side: Literal["left", "right"] = "right" if yaw >= 0 else "left"
    if _is_aside(yaw):
        return side
    return ORIENTATIONS[ORIENTATIONS.index(side) + (4 if abs(yaw) < 90.0 else 2)]


def front_of(
    before: Front,
    yaw: float,
    shown: tuple[float, float] | None,
    named: Orientation | None,
    dt_s: float,
) -> tuple[Front, bool]:
    """The new memory, and whether a proposal must be flipped.

    A hidden Markov model of two states, between which people change through their side, where the
    silhouette is unambiguous. The picture's faces and feet are the main evidence, proposals add a
    little.

    Args:
        before: At the frame before.
        yaw: Of the proposal, degrees.
        shown: Facing in the picture, degrees, and its confidence; None: unknown.
        named: The user's input, which settles it.
        dt_s: Time since the frame before.
    """
    aside = _is_aside(yaw)
    if named is not None:
        told = 0.5 if named in ("left", "right") else float(named.startswith("backward"))
        return Front(told), told != 0.5 and (told == 1.0) != (abs(yaw) > 90.0)
    anew = 1.0 - math.exp(-dt_s * (ANEW_ASIDE_HZ if aside else ANEW_HZ))
    away = (1.0 - anew) * before.away + anew * 0.5
    said = 0.0 if aside else math.copysign(PROPOSED_HZ, abs(yaw) - 90.0)
    if shown is not None and shown[1] > 0.5:
        sure = min(shown[1], SUREST)
        said -= SHOWN_HZ * math.log(sure / (1.0 - sure)) * math.cos(math.radians(shown[0]))
    odds = min(max(said * dt_s, -CERTAIN), CERTAIN)
    away /= away + (1.0 - away) * math.exp(-odds)
    return Front(away), not aside and (away > 0.5) != (abs(yaw) > 90.0)


def as_known(before: Front, yaw: float) -> Front:
    """The memory of front and back, converted to another camera: as sure as before, and less where
    the person is seen from the side.

    Args:
        before: Of the view that was alone until now.
        yaw: In this camera, of the previous body, degrees.
    """
    sure = abs(before.away - 0.5)
    return Front(0.5 - sure * math.cos(math.radians(yaw)))


def as_shown(camera: Camera, joints_m: Joints, shown: tuple[float, float] | None) -> Joints:
    """The body mirrored in depth about the pelvis, where it faces left in the picture instead of
    right, or right instead of left: both profiles have nearly the same silhouette.

    Args:
        camera: The view's.
        joints_m: (15, 3) world.
        shown: As for `front_of`.
    """
    if shown is None or shown[1] < FACES:
        return joints_m
    yaw, said = math.radians(yaw_deg(camera, joints_m)), math.radians(shown[0])
    if math.cos(said - yaw) > 0.0 or math.cos(said + yaw) <= 0.0:
        return joints_m
    depth = _depths(camera, joints_m)
    return _at_depths(camera, joints_m, 2 * depth[PELVIS] - depth)


def _is_aside(yaw: float) -> bool:
    return abs(abs(yaw) - 90.0) <= SIDEWAYS_DEG


def agrees(yaw: float, named: Orientation) -> bool:
    """Whether a yaw is possible for the orientation that the user named."""
    middle = {"forward": 35.0, "left": 90.0, "right": 90.0, "backward": 145.0}
    wide = SIDEWAYS_DEG if named in ("left", "right") else 35.0
    side = 1.0 if named.endswith("right") else -1.0
    off = (yaw - side * middle[named.split("_")[0]] + 180.0) % 360.0 - 180.0
    return abs(off) <= wide + NEARLY_DEG


def seen_from_behind(camera: Camera, joints_m: Joints) -> Joints:
    """The body with the same silhouette that faces the other way, front for back.

    Each joint stays on its ray and is mirrored in depth about the pelvis; sides are exchanged.
    """
    depth = _depths(camera, joints_m)
    return _at_depths(camera, joints_m, 2 * depth[PELVIS] - depth)[OTHER_SIDE]


def leaning(camera: Camera, joints_m: Joints, depth: Mapping[str, str]) -> Joints:
    """The body whose segments lean as annotated, toward the camera or away, each by the same angle
    as before.

    Args:
        camera: The view's.
        joints_m: (15, 3) world.
        depth: Names of LIMBS to toward or away (T21).
    """
    depths_m = _depths(camera, joints_m)
    for limb, name in enumerate(LIMBS):
        near, far = LIMB_ENDS[limb]
        farther = depths_m[far] - depths_m[near]
        if name in depth and (farther > 0) == (depth[name] == "toward"):
            depths_m[_HANGS[limb]] -= 2 * farther
    return _at_depths(camera, joints_m, depths_m)


def mirrored(camera: Camera, joints_m: Joints, limb: int) -> Joints:
    """The body with one of LIMBS mirrored in depth."""
    depths_m = _depths(camera, joints_m)
    near, far = LIMB_ENDS[limb]
    depths_m[_HANGS[limb]] -= 2 * (depths_m[far] - depths_m[near])
    return _at_depths(camera, joints_m, depths_m)


def as_deep(camera: Camera, joints_m: Joints, other_m: Joints) -> Joints:
    """The joints on the picture's rays, at another body's distances."""
    return _at_depths(camera, joints_m, _depths(camera, other_m))


def _depths(camera: Camera, joints_m: Joints) -> Joints:
    found: Joints = (joints_m - centre(camera)) @ arrays_of(camera).R[2]
    return found


def _at_depths(camera: Camera, joints_m: Joints, depths_m: Joints) -> Joints:
    """The joints moved along their rays."""
    eye = centre(camera)
    found: Joints = eye + (joints_m - eye) * (depths_m / _depths(camera, joints_m))[:, None]
    return found
