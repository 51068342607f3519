"""Network input from the landmarks of each view, relative to the cameras' places."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, OTHER_SIDE, Vector
from common.body.extremities import cross
from common.body.observation import Observation
from common.rig.camera import Camera, Rig, arrays_of, centre, rays
from integrator.proposal.silhouette_window import (
    FAR_M,
    LONGEST_S,
    NEAR_M,
    NEARNESS,
    USUAL_S,
    Floats,
    axes_of,
)
from integrator.rig.body_position import triangulate

JOINTS: Final = len(JOINT_NAMES)
FACED, STANDS, KNOWN = 3 * JOINTS, 3 * JOINTS + 3, 3 * JOINTS + 8
"""Layout of one view's input after joints and confidences: start of the facing, start of the
camera's place, end."""
INPUTS: Final = 2 * KNOWN + 2
"""Number of inputs: those of both views, the time since the input before, and whether both see."""
MIDDLE: Final = [JOINT_NAMES.index(name) for name in ("l_shoulder", "r_shoulder", "l_hip", "r_hip")]
ANKLES: Final = [JOINT_NAMES.index(name) for name in ("l_ankle", "r_ankle")]
PELVIS, NECK = JOINT_NAMES.index("pelvis"), JOINT_NAMES.index("neck")
UP: Final = np.array([0.0, 1.0, 0.0])

ANKLE_UP: Final = 0.045
"""Height of an ankle above the floor, statures."""
SURE: Final = 0.3
"""Confidence in the lower ankle from which on it determines the person's distance."""
SPREAD: Final = 0.33
"""Distance of joints from their middle, statures, used where nothing else determines the
distance."""
LEAST_SPREAD: Final = 1e-3
STRETCHED: Final = 2.0
"""Ratio of the distance by the floor to that by the joints' size above which, far off, the ankle is
not on the floor: arms and legs that are stretched bring the size's distance down by less."""
STEEPEST: Final = 1e-3
"""Cosine of the angle between a ray and the floor for a person seen from above or below."""
ASLANT: Final = 0.05
"""Smallest cosine of the angle to the line of sight of a joint beside the body's middle."""
BEYOND: Final = 1.2
"""Largest distance of a joint from the middle, statures."""
LEANS: Final = 3.0**0.5
"""Tangent of the angle from the horizontal at which a trunk leans by 30 degrees; a facing of one
that leans farther refers to the trunk and is not used here."""


class Shown(NamedTuple):
    """One view's landmarks."""

    joints_px: NDArray[np.float64]
    """(15, 2) undistorted."""
    confidence: Vector
    """(15,) confidence."""
    facing_deg: float
    facing_confidence: float


class Look(NamedTuple):
    """The input of the lifting network, and its frame."""

    inputs: Floats
    """(INPUTS,)"""
    middle_m: Vector
    """(3,) place of the body, world."""
    turn: Vector
    """(3, 3) rows: the axes of the network's frame in the world; left-handed where mirrored."""
    mirrored: bool
    """True: the input is mirrored, so right limbs are left ones."""


def shown_of(person: Observation | None) -> Shown | None:
    """A person's landmarks; None where there are none."""
    found = None if person is None else person.landmarks
    if found is None:
        return None
    joints_px, confidence = np.array(found.joints_px), np.array(found.confidence)
    return Shown(joints_px, confidence, found.facing_deg, found.facing_confidence)


def look(
    shown: tuple[Shown | None, Shown | None], rig: Rig, stature_m: float, since_s: float
) -> Look | None:
    """The landmarks as network input; None where they show no person, or not one body.

    Args:
        shown: The views, at least one present.
        rig: The cameras without distortion; their world has y up and its floor at 0.
        stature_m: The person's stature.
        since_s: Time since the input before.
    """
    told = [(one, camera) for one, camera in zip(shown, rig.cameras, strict=True) if one]
    (first, one), (second, other) = told[0], told[-1]
    if len(told) > 1:
        middle_m, firm = _where_both_see(first, second, rig), True
    else:
        middle_m, firm = _where_it_stands(first, one, stature_m)
    turn = axes_of(one, other)
    if middle_m is None:
        return None
    mirrored = bool(np.linalg.det(turn) < 0.0)
    inputs = np.zeros(INPUTS, np.float32)
    for n, (seen, camera) in enumerate(told):
        away_m = centre(camera) - middle_m
        far_m = float(np.linalg.norm(away_m))
        plane = _on_plane(rays(camera, seen.joints_px), -away_m / far_m)
        if plane is None:
            return None
        own = inputs[n * KNOWN : (n + 1) * KNOWN]
        _tell_joints(own, plane * far_m / stature_m, seen, mirrored)
        near = NEARNESS * stature_m / min(far_m, FAR_M) - 1.0
        own[STANDS:KNOWN] = *(turn @ away_m / far_m), near, firm
    inputs[-2:] = min(since_s, LONGEST_S) / USUAL_S - 1.0, len(told) - 1.0
    return Look(inputs, middle_m, turn, mirrored)


def _tell_joints(own: Floats, statures: NDArray[np.float64], seen: Shown, mirrored: bool) -> None:
    """Places of the joints, (15, 2) from the middle, their confidence, and the facing."""
    trunk = statures[NECK] - statures[PELVIS]
    heard = seen.facing_confidence if trunk[1] > LEANS * abs(trunk[0]) else 0.0
    confidence, facing = seen.confidence, np.radians(seen.facing_deg)
    if mirrored:
        statures, confidence = statures[OTHER_SIDE] * [-1.0, 1.0], confidence[OTHER_SIDE]
        facing = -facing
    own[: 2 * JOINTS] = 2.0 * statures.clip(-BEYOND, BEYOND).ravel()
    own[2 * JOINTS : FACED] = 2.0 * confidence - 1.0
    own[FACED:STANDS] = heard * np.cos(facing), heard * np.sin(facing), 2.0 * heard - 1.0


def _on_plane(seen: NDArray[np.float64], forward: Vector) -> NDArray[np.float64] | None:
    """Intersections of rays (n, 3) with the plane at depth 1 of an upright camera that looks
    along `forward`: (n, 2) to the right and up; None where it looks straight up or down."""
    back = -forward * [1.0, 0.0, 1.0]
    flat = float(np.linalg.norm(back))
    if flat < STEEPEST:
        return None
    right = cross(UP, back / flat)
    across = np.stack([seen @ right, seen @ cross(right, forward)], axis=1)
    return np.asarray(across / np.maximum(seen @ forward, ASLANT)[:, None])


def _where_both_see(first: Shown, second: Shown, rig: Rig) -> Vector | None:
    """Intersection of the rays to both views' middles, in front of both cameras."""
    cameras = rig.cameras[0], rig.cameras[1]
    left, right = (tuple(one.joints_px[MIDDLE].mean(axis=0).tolist()) for one in (first, second))
    found_m: Vector = triangulate(cameras, (left, right))
    depths_m = [float(arrays_of(one).R[2] @ found_m + one.t[2]) for one in cameras]
    return found_m if np.isfinite(depths_m).all() and min(depths_m) >= NEAR_M else None


def _where_it_stands(shown: Shown, camera: Camera, stature_m: float) -> tuple[Vector | None, bool]:
    """The middle of one view's landmarks, and whether its distance comes from an ankle on the
    floor; otherwise it comes from their size."""
    seen = rays(camera, shown.joints_px)
    forward = seen[MIDDLE].mean(axis=0)
    forward /= np.linalg.norm(forward)
    plane = _on_plane(seen, forward)
    if plane is None:
        return None, False
    low = ANKLES[int(plane[ANKLES[1], 1] < plane[ANKLES[0], 1])]
    drop_m = centre(camera)[1] - ANKLE_UP * stature_m
    falls, along = -float(seen[low, 1]), float(seen[low] @ forward)
    floor_m = drop_m / falls * along if falls > 0.0 and drop_m > 0.0 else np.inf
    off = ((plane - plane[MIDDLE].mean(axis=0)) ** 2).sum(axis=1)
    spread = np.sqrt(shown.confidence @ off / max(float(shown.confidence.sum()), LEAST_SPREAD))
    size_m = max(SPREAD * stature_m / max(spread, LEAST_SPREAD), NEAR_M)
    firm = bool(shown.confidence[low] >= SURE and NEAR_M < floor_m < max(FAR_M, STRETCHED * size_m))
    return centre(camera) + forward * (floor_m if firm else size_m), firm
