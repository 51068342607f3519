"""How far off joints and clinical angles may be: bands that hold with 68 and with 95 %.

Each joint's spread is that of the fusion's covariance, which its confidence tells, and how far the
body moves in LAG_S: what is lively is less certain than the fusion knows. An angle's spread is that
of its joints, by the derivatives of the angle. A band is a floor plus so many spreads.
"""

from typing import Final, NamedTuple

import numpy as np

from animator.clinical.clinical_angles import NAMES, clinical_angles
from common.body.body import JOINT_NAMES, Floats, Vector
from common.body.extremities import ALL_JOINT_NAMES
from common.body.joint_spread import spread_of

STEP_M: Final = 1e-3
"""Step of the derivatives."""
AT_ONCE: Final = 5_000
"""Frames whose derivatives are taken together."""
LAG_S: Final = 0.05
LIVELY_S: Final = 2.0
"""Seconds over which the body's speed is averaged."""


class Reach(NamedTuple):
    """The half width of two bands, by the spread of a quantity."""

    floor_68: float
    spreads_68: float
    floor_95: float
    spreads_95: float

    def of(self, spread: Floats) -> Floats:
        """Half widths of the 68 and the 95 % band, in a new last axis."""
        found: Floats = np.stack(
            [
                self.floor_68 + self.spreads_68 * spread,
                self.floor_95 + self.spreads_95 * spread,
            ],
            axis=-1,
        )
        return found


ANGLES: Final = {
    "pelvis_tilt": Reach(1.81, 0.07, 2.78, 0.15),
    "pelvis_list": Reach(0.0, 0.09, 0.0, 0.21),
    "pelvis_rotation": Reach(1.44, 0.16, 1.01, 0.48),
    "lumbar_bending": Reach(0.01, 0.13, 0.0, 0.28),
    "lumbar_rotation": Reach(0.0, 0.16, 0.0, 0.56),
    "hip_flexion": Reach(1.47, 0.21, 2.2, 0.53),
    "hip_adduction": Reach(0.0, 0.12, 0.0, 0.24),
    "hip_rotation": Reach(1.16, 0.11, 1.79, 0.25),
    "knee_angle": Reach(0.0, 0.31, 0.57, 0.84),
    "arm_flex": Reach(1.78, 0.31, 0.27, 1.0),
    "arm_add": Reach(0.89, 0.3, 0.0, 0.77),
    "arm_rot": Reach(0.0, 0.24, 0.0, 1.03),
    "elv_angle": Reach(0.0, 0.37, 0.0, 1.02),
    "shoulder_elv": Reach(0.5, 0.26, 0.26, 0.74),
    "elbow_flex": Reach(0.0, 0.44, 0.0, 0.9),
    "ankle_angle": Reach(0.0, 0.31, 0.57, 0.84),
    "lumbar_extension": Reach(0.0, 0.0, 0.0, 0.0),
    "pro_sup": Reach(0.0, 0.0, 0.0, 0.0),
}
"""By angle: each frame alike of two performers of 15 postures and two in free motion. No truth has
heels: an ankle's are those of a knee."""
JOINTS: Final = {
    "pelvis": Reach(13.94, 0.39, 40.11, 0.33),
    "neck": Reach(23.05, 0.04, 30.51, 0.15),
    "head_top": Reach(30.61, 0.59, 42.25, 0.86),
    "shoulder": Reach(19.16, 0.27, 34.21, 0.25),
    "elbow": Reach(13.13, 0.74, 3.64, 2.31),
    "wrist": Reach(19.33, 0.54, 22.06, 1.63),
    "hip": Reach(14.27, 0.4, 40.5, 0.36),
    "knee": Reach(12.19, 0.39, 27.45, 0.56),
    "ankle": Reach(7.89, 0.51, 19.72, 0.7),
}
"""By joint: postures, free motion and made-up people alike, as joints are off by their person."""


def spreads_m(joints_m: Floats, confidence: Floats, time_s: Vector) -> Floats:
    """Standard deviation of a coordinate of each joint, (n, joints).

    Args:
        joints_m: (n, joints, 3), NaN where there is no pose; the first 15 are JOINT_NAMES.
        confidence: (n, joints)
        time_s: (n,) increasing.
    """
    moved_m = LAG_S * _speed(joints_m[:, : len(JOINT_NAMES)], time_s)
    found: Floats = np.hypot(spread_of(confidence), moved_m[:, None])
    return found


def _speed(joints_m: Floats, time_s: Vector) -> Vector:
    """Mean speed of all joints around each row, metres a second; 0 where it is not known."""
    if len(time_s) < 2:
        return np.zeros(len(time_s))
    steps_m = np.linalg.norm(np.diff(joints_m, axis=0), axis=2).mean(axis=1)
    steps_s = np.maximum(np.diff(time_s), 1e-6)
    known = np.isfinite(steps_m)
    sums = [np.append(0.0, np.cumsum(np.where(known, part, 0.0))) for part in (steps_m, steps_s)]
    first = np.searchsorted(time_s, time_s - LIVELY_S / 2)
    last = np.searchsorted(time_s, time_s + LIVELY_S / 2, "right") - 1
    moved_m, lasted_s = (part[last] - part[first] for part in sums)
    found: Vector = np.where(lasted_s > 0.0, moved_m / np.maximum(lasted_s, 1e-6), 0.0)
    return found


def joint_bands_mm(spread_m: Floats) -> Floats:
    """Half widths of the joints' bands, (n, 15, 2) mm: the joint is as near with 68 and with 95 %.

    Args:
        spread_m: (n, 15) of JOINT_NAMES.
    """
    spread_mm = 1e3 * spread_m
    bands = [JOINTS[sideless(name)].of(spread_mm[:, n]) for n, name in enumerate(JOINT_NAMES)]
    return np.stack(bands, axis=1)


def angle_bands_deg(joints_m: Floats, spread_m: Floats) -> Floats:
    """Half widths of the clinical angles' bands, (n, len(NAMES), 2) degrees.

    Args:
        joints_m: (n, 22, 3) world, in the order of ALL_JOINT_NAMES.
        spread_m: (n, 22) of these.
    """
    parts = [
        angle_spreads_deg(joints_m[at : at + AT_ONCE], spread_m[at : at + AT_ONCE])
        for at in range(0, max(len(joints_m), 1), AT_ONCE)
    ]
    spread_deg = np.concatenate(parts)
    bands = [ANGLES[sideless(name)].of(spread_deg[:, n]) for n, name in enumerate(NAMES)]
    return np.stack(bands, axis=1)


def angle_spreads_deg(joints_m: Floats, spread_m: Floats) -> Floats:
    """Standard deviations of the clinical angles, (n, len(NAMES)) degrees, as far as the joints'
    own tell: to first order, each joint's alike in all directions."""
    variance_m2 = spread_m**2
    before = clinical_angles(joints_m)
    found = np.zeros_like(before)
    for joint in range(len(ALL_JOINT_NAMES)):
        for axis in range(3):
            moved = joints_m.copy()
            moved[:, joint, axis] += STEP_M
            turned = (clinical_angles(moved) - before + 180.0) % 360.0 - 180.0
            found += (turned / STEP_M) ** 2 * variance_m2[:, joint, None]
    spread: Floats = np.sqrt(found)
    return spread


def sideless(name: str) -> str:
    """Both sides have one reach: `knee_angle_r` is knee_angle, `l_hip` is hip."""
    return name.removesuffix("_r").removesuffix("_l").removeprefix("r_").removeprefix("l_")
