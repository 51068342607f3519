"""Joint angles by OpenSim's and ISB's conventions, from the places of the joints.

The frames are OpenSim's: x forward, y up, z to the right of the person; turns about z, then x, then
y, each about the axis that the turn before has moved. Names, signs and zeros are those of
Rajagopal's model; `elv_angle` and `shoulder_elv` are those of Saul's arm. A standing body with
hanging arms that faces camera 1 has zero everywhere.

Source: Rajagopal et al. 2016 (OpenSim's full-body model); Saul et al. 2015; Wu et al. 2002 and 2005
(ISB's recommendations).
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.body.extremities import ALL_JOINT_NAMES

TRUNK_NAMES: Final = (
    *("pelvis_tilt", "pelvis_list", "pelvis_rotation"),
    *("lumbar_extension", "lumbar_bending", "lumbar_rotation"),
)
SIDE_NAMES: Final = (
    *("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle"),
    *("arm_flex", "arm_add", "arm_rot", "elv_angle", "shoulder_elv", "elbow_flex", "pro_sup"),
)
NAMES: Final = (*TRUNK_NAMES, *(f"{name}_{side}" for side in "rl" for name in SIDE_NAMES))
"""The angles, in the order of all arrays of them."""
UNSEEN: Final = ("lumbar_extension", "pro_sup_r", "pro_sup_l")
"""Never known: joints show neither the pelvis's tilt apart from the trunk's nor a hand's turn."""
STRAIGHT_DEG: Final = 25.0
"""Bend of a knee or an elbow below which it does not show how thigh or upper arm is turned."""
UPRIGHT_DEG: Final = 25.0
"""Elevation of an arm, from hanging or from straight up, below which it is in no plane."""
SIDEWAYS_DEG: Final = 65.0
"""Adduction or abduction of a limb beyond which its flexion is about its own axis."""

_AT: Final = {name: i for i, name in enumerate(ALL_JOINT_NAMES)}
_TO_OPENSIM: Final = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""From the world's axes to OpenSim's."""


class Limb(NamedTuple):
    """A limb in the axes of what it hangs on, mirrored to the right side; n frames."""

    flexion: Vector
    adduction: Vector
    rotation: Vector
    bend: Vector
    """Between its upper and its lower part."""


def clinical_angles(joints_m: Floats) -> Floats:
    """All angles of all frames, whether they are defined or not, (n, len(NAMES)) degrees.

    Args:
        joints_m: (n, 22, 3) world, in the order of ALL_JOINT_NAMES; NaN where there is no pose.
    """
    joints = joints_m @ _TO_OPENSIM.T
    pelvis, torso = trunk_axes(joints)
    found = dict(zip(TRUNK_NAMES[:3], _turns(pelvis), strict=True))
    found |= dict(zip(TRUNK_NAMES[3:], _turns(_within(pelvis, torso)), strict=True))
    for side in "rl":
        own = _side(joints, side, pelvis, torso)
        found |= {f"{name}_{side}": values for name, values in own.items()}
    return np.stack([np.degrees(found[name]) for name in NAMES], axis=1)


def defined(angles_deg: Floats, feet_seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each angle is defined, (n, len(NAMES)).

    Args:
        angles_deg: (n, len(NAMES)) of `clinical_angles`.
        feet_seen: (n, 2) whether heel and toe were measured, right and left.
    """
    known = np.isfinite(angles_deg)
    own = {name: angles_deg[:, n] for n, name in enumerate(NAMES)}
    for n, side in enumerate("rl"):
        bent = {part: own[f"{part}_{side}"] > STRAIGHT_DEG for part in ("knee_angle", "elbow_flex")}
        raised = np.abs(own[f"shoulder_elv_{side}"] - 90.0) < 90.0 - UPRIGHT_DEG
        conditions = {
            "hip_flexion": np.abs(own[f"hip_adduction_{side}"]) < SIDEWAYS_DEG,
            "hip_rotation": bent["knee_angle"],
            "ankle_angle": feet_seen[:, n],
            "arm_flex": np.abs(own[f"arm_add_{side}"]) < SIDEWAYS_DEG,
            "arm_rot": bent["elbow_flex"] & (np.abs(own[f"arm_add_{side}"]) < SIDEWAYS_DEG),
            "elv_angle": raised,
        }
        for name, holds in conditions.items():
            known[:, NAMES.index(f"{name}_{side}")] &= holds
    known[:, [NAMES.index(name) for name in UNSEEN]] = False
    return known


def continuous(angles_deg: Floats, known: NDArray[np.bool_]) -> Floats:
    """The angles where they are defined, NaN elsewhere; one that passes 180 goes on beyond it as
    long as it is defined."""
    found = np.where(known, angles_deg, np.nan)
    for column in found.T:
        gaps = np.flatnonzero(np.diff(np.isfinite(column))) + 1
        for part in np.split(np.arange(len(column)), gaps):
            if len(part) and np.isfinite(column[part[0]]):
                column[part] = np.unwrap(column[part], period=360.0)
    return found


def trunk_axes(joints: Floats) -> tuple[Floats, Floats]:
    """Axes of pelvis and torso as columns, (n, 3, 3): forward, up, right.

    Both have the line from the middle of the hips to the neck for up; the pelvis has the hips for
    its right exactly, the torso has that line for its up exactly.
    """
    up = joints[:, _AT["neck"]] - joints[:, _AT["pelvis"]]
    hips = _unit(joints[:, _AT["r_hip"]] - joints[:, _AT["l_hip"]])
    shoulders = joints[:, _AT["r_shoulder"]] - joints[:, _AT["l_shoulder"]]
    pelvis_up = _unit(up - _dot(up, hips)[:, None] * hips)
    pelvis = np.stack([np.cross(pelvis_up, hips), pelvis_up, hips], axis=2)
    torso_up = _unit(up)
    right = _unit(shoulders - _dot(shoulders, torso_up)[:, None] * torso_up)
    return pelvis, np.stack([np.cross(torso_up, right), torso_up, right], axis=2)


def _side(joints: Floats, side: str, pelvis: Floats, torso: Floats) -> dict[str, Vector]:
    """The angles of one side, radians."""
    mirror = np.array([1.0, 1.0, 1.0 if side == "r" else -1.0])

    def place(name: str, base: Floats) -> Floats:
        """A joint in the axes of pelvis or torso; of the left side as if it were the right one."""
        inside: Floats = np.einsum("nij,ni->nj", base, joints[:, _AT[f"{side}_{name}"]]) * mirror
        return inside

    hip, knee, ankle = (place(name, pelvis) for name in ("hip", "knee", "ankle"))
    leg = _limb(hip, knee, ankle, -1.0)
    foot, shank = place("toe", pelvis) - place("heel", pelvis), knee - ankle
    shoulder, elbow, wrist = (place(name, torso) for name in ("shoulder", "elbow", "wrist"))
    arm, along = _limb(shoulder, elbow, wrist, 1.0), _unit(elbow - shoulder)
    return {
        "hip_flexion": leg.flexion,
        "hip_adduction": leg.adduction,
        "hip_rotation": leg.rotation,
        "knee_angle": leg.bend,
        "ankle_angle": np.pi / 2 - _between(foot, shank),
        "arm_flex": arm.flexion,
        "arm_add": arm.adduction,
        "arm_rot": arm.rotation,
        "elv_angle": np.arctan2(along[:, 0], along[:, 2]),
        "shoulder_elv": np.arctan2(np.hypot(along[:, 0], along[:, 2]), -along[:, 1]),
        "elbow_flex": arm.bend,
        "pro_sup": np.full(len(joints), np.nan),
    }


def _limb(start: Floats, middle: Floats, end: Floats, way: float) -> Limb:
    """Angles of an upper limb whose lower part bends forwards (1) or backwards (-1)."""
    upper, lower = middle - start, end - middle
    up = _unit(-upper)
    right = _unit(way * np.cross(upper, lower))
    axes = np.stack([np.cross(up, right), up, right], axis=2)
    flexion, adduction, rotation = _turns(axes)
    return Limb(flexion, adduction, rotation, _between(upper, lower))


def _turns(axes: Floats) -> tuple[Vector, Vector, Vector]:
    """Turns about z, then x, then y, radians, of axes given as columns (n, 3, 3)."""
    about_x = np.arcsin(np.clip(axes[:, 2, 1], -1.0, 1.0))
    about_z = np.arctan2(-axes[:, 0, 1], axes[:, 1, 1])
    about_y = np.arctan2(-axes[:, 2, 0], axes[:, 2, 2])
    return about_z, about_x, about_y


def _within(base: Floats, axes: Floats) -> Floats:
    found: Floats = np.einsum("nji,njk->nik", base, axes)
    return found


def _between(one: Floats, other: Floats) -> Vector:
    """Angle between directions, radians."""
    found: Vector = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), _dot(one, other))
    return found


def _dot(one: Floats, other: Floats) -> Vector:
    found: Vector = np.einsum("ni,ni->n", one, other)
    return found


def _unit(arrows: Floats) -> Floats:
    found: Floats = arrows / np.maximum(np.linalg.norm(arrows, axis=1, keepdims=True), 1e-9)
    return found
