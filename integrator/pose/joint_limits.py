"""Poses within the limits of joints, with limbs turned as little as necessary (P30, P35)."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import (
    ANGLE_NAMES,
    ANGLES_IN_POSE,
    ELBOW,
    HIP,
    KNEE,
    LIMITS_DEG,
    SHOULDER,
    Floats,
    Vector,
)
from common.body.kinematics import joints
from common.compiled import compiled
from integrator.pose.inverse_kinematics import HIGH_DEG, LOW_DEG, apart, bend, cosine, turn_deg

TWIST_DEG: Final = 60.0
"""Largest turn of a thigh about its own axis, degrees, to either side of the knee pointing
forwards: a knee that bends forwards would take a half turn (T22: knees bend backwards)."""

OFF: Final = 20.0
"""Cost of a degree off a limb's direction, over that of a degree from the pose before. With it
an arm is turned by 13 to 18 degrees at most before another solution is taken, in which it is
raised over the head to the same place."""

_LOWS, _HIGHS = LOW_DEG[list(ANGLES_IN_POSE)], HIGH_DEG[list(ANGLES_IN_POSE)]
_MIDDLES: Final = np.array([sum(LIMITS_DEG.get(name, (0.0, 0.0))) / 2 for name in ANGLE_NAMES])


def clipped(angles_deg: Vector) -> Vector:
    """The 17 angles, wrapped into the turn of their limits and clipped to them.

    Smoothed angles overshoot, for example at a straight knee, and pass through whole turns.
    """
    turned = angles_deg - 360.0 * np.round((angles_deg - _MIDDLES) / 360.0)
    found: Vector = np.clip(turned, _LOWS, _HIGHS)
    return found


def within(
    body: Vector, pose: Vector, before: Vector, joints_m: NDArray[np.float64]
) -> tuple[Vector, NDArray[np.float64]]:
    """A pose held within the limits, and joints moved by the same turns of the limbs.

    Args:
        body: Body vector.
        pose: The pose of the joints.
        before: Pose of the frame before.
        joints_m: (15, 3) world.
    """
    kept = held(pose, before)
    if np.array_equal(kept, pose):
        return pose, joints_m
    return kept, joints_m + joints(body, kept) - joints(body, pose)


@compiled
def held(pose: Vector, before: Vector) -> Floats:
    """The pose with every limb within the limits of its joints, (25,).

    A direction has two pairs of theta_X and theta_Z. Each is brought as near to it as the limits
    allow, and the likelier one is taken. So an arm that seems to hang a little inwards becomes a
    straight one, not one that passes over the head.

    Args:
        pose: From `pose_of`.
        before: Pose of the frame before.
    """
    found = pose.copy()
    for side in range(2):
        _hold(found, before, SHOULDER + 3 * side, ELBOW + side)
        _hold(found, before, HIP + 3 * side, KNEE + side)
    return found


@compiled
def _hold(pose: Vector, before: Vector, at: int, at_bend: int) -> None:
    """Hold one limb within its limits; the lower half keeps its direction where possible."""
    x, y, z = pose[at], pose[at + 1], pose[at + 2]
    lower = _along(x, y, z, pose[at_bend])
    if not (_is_within(x, at) and _is_within(z, at + 2)):
        pose[at], pose[at + 2] = _nearest(_along(x, y, z, 0.0), at, before)
        bend(pose, at, at_bend, lower)
    if at >= HIP:
        _untwist(pose, at, at_bend, lower)
    pose[at_bend] = min(max(pose[at_bend], LOW_DEG[at_bend]), HIGH_DEG[at_bend])


@compiled
def _untwist(pose: Vector, at: int, at_bend: int, lower: Vector) -> None:
    """Turn back a knee that points too far aside."""
    x, z = math.radians(pose[at]), math.radians(pose[at + 2])
    ahead_deg = math.degrees(math.atan2(math.sin(x) * math.sin(z), -math.cos(z)))
    twist_deg = apart(pose[at + 1], ahead_deg)
    if abs(twist_deg) > TWIST_DEG:
        pose[at + 1] = ahead_deg + math.copysign(TWIST_DEG, twist_deg)
        pose[at_bend] = min(0.0, turn_deg(lower, pose, at))


@compiled
def _nearest(axis: Vector, at: int, before: Vector) -> tuple[float, float]:
    """theta_X and theta_Z within their limits that align a limb with an axis, or nearly."""
    straight_deg = math.degrees(math.atan2(-axis[0], axis[1]))
    best, x, z = math.inf, 0.0, 0.0
    for half in (0.0, 180.0):
        own_z = _into(straight_deg + half, at + 2)
        turn = math.radians(own_z)
        own_x = _into(
            math.degrees(math.atan2(axis[2], math.cos(turn) * axis[1] - math.sin(turn) * axis[0])),
            at,
        )
        came = _along(own_x, 0.0, own_z, 0.0)
        off_deg = math.degrees(
            math.acos(cosine(came[0] * axis[0] + came[1] * axis[1] + came[2] * axis[2]))
        )
        turned_deg = abs(apart(own_x, before[at])) + abs(apart(own_z, before[at + 2]))
        if OFF * off_deg + turned_deg < best:
            best, x, z = OFF * off_deg + turned_deg, own_x, own_z
    return x, z


@compiled
def _is_within(angle_deg: float, at: int) -> bool:
    return LOW_DEG[at] <= angle_deg <= HIGH_DEG[at]


@compiled
def _into(angle_deg: float, at: int) -> float:
    """The angle in the turn of its limits, or the nearer limit."""
    middle = (LOW_DEG[at] + HIGH_DEG[at]) / 2
    return min(max(middle + apart(angle_deg, middle), LOW_DEG[at]), HIGH_DEG[at])


@compiled
def _along(x_deg: float, y_deg: float, z_deg: float, bend_deg: float) -> Floats:
    """Direction of a lower limb in the trunk's axes: R_z R_x R_y R_x(bend) of the upward axis."""
    x, y, z, b = (
        math.radians(x_deg), math.radians(y_deg), math.radians(z_deg), math.radians(bend_deg)
    )  # fmt: skip
    across, front = math.sin(b) * math.sin(y), math.sin(b) * math.cos(y)
    up = math.cos(x) * math.cos(b) - math.sin(x) * front
    return np.array(
        [
            math.cos(z) * across - math.sin(z) * up,
            math.sin(z) * across + math.cos(z) * up,
            math.sin(x) * math.cos(b) + math.cos(x) * front,
        ]
    )
