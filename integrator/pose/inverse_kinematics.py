"""Inverse kinematics: from twelve joints to the angles of the ten cylinders."""

import math
from typing import Final

import numpy as np

from common.body.body import (
    ELBOW,
    HIP,
    KNEE,
    LIMITS_DEG,
    POSE_NAMES,
    SHOULDER,
    TORSO_X,
    TORSO_Y,
    TORSO_Z,
    Floats,
    Vector,
)
from common.body.proportions import (
    HIPS_UP,
    PER_ELLIPTIC,
    PER_ROUND,
    UPPER_ARM_HEIGHT,
    UPPER_LEG_HEIGHT,
)
from common.compiled import compiled

PLACES: Final = {
    f"{side}_{name}": 2 * i + (side == "r")
    for i, name in enumerate(("shoulder", "elbow", "wrist", "hip", "knee", "ankle"))
    for side in "lr"
}
"""Index of each joint among the twelve."""

STRAIGHT_DEG: Final = 12.0
"""Bend of an arm, degrees, below which its twist is undetermined."""
ASTRAY: Final = 3.0
"""Cost of a degree beyond a joint's limits, over that of a degree from the pose before."""

LOW_DEG: Final = np.array([LIMITS_DEG.get(name, (-np.inf, np.inf))[0] for name in POSE_NAMES])
HIGH_DEG: Final = np.array([LIMITS_DEG.get(name, (-np.inf, np.inf))[1] for name in POSE_NAMES])
"""Limits of each parameter of a pose."""


@compiled
def pose_of(joints_m: Floats, body: Vector, before: Vector) -> Floats:
    """The pose, (25,), whose landmarks point from joint to joint as the given ones; lengths are the
    body's.

    Args:
        joints_m: (12, 3) world, in the order of PLACES.
        body: Body vector.
        before: Pose of the frame before: of two solutions, the nearer one is taken.
    """
    pose = before.copy()
    trunk = trunk_of(joints_m)
    for i in range(3):
        pose[i] = (joints_m[6, i] + joints_m[7, i]) / 2 - body[HIPS_UP] * trunk[i, 1]
    # theta_X, theta_Y, theta_Z of R_y R_x R_z
    pose[TORSO_X] = -math.degrees(math.asin(cosine(trunk[1, 2])))
    pose[TORSO_Y] = math.degrees(math.atan2(trunk[0, 2], trunk[2, 2]))
    pose[TORSO_Z] = math.degrees(math.atan2(trunk[1, 0], trunk[1, 1]))
    own = np.empty((12, 3))
    for place in range(12):
        for i in range(3):
            own[place, i] = (
                joints_m[place, 0] * trunk[0, i]
                + joints_m[place, 1] * trunk[1, i]
                + joints_m[place, 2] * trunk[2, i]
            )
    for side in range(2):
        shoulder, elbow, wrist = own[1 - side], own[3 - side], own[5 - side]
        upper_arm, arm = body[UPPER_ARM_HEIGHT + PER_ROUND * side], SHOULDER + 3 * side
        _set_limb(pose, shoulder, elbow, wrist, upper_arm, arm, ELBOW + side)
        hip, knee, ankle = own[7 - side].copy(), own[9 - side], own[11 - side]
        hip[1] -= body[HIPS_UP]
        thigh, leg = body[UPPER_LEG_HEIGHT + PER_ELLIPTIC * side], HIP + 3 * side
        _set_limb(pose, hip, knee, ankle, thigh, leg, KNEE + side)
    return pose


@compiled
def trunk_of(joints_m: Floats) -> Floats:
    """Axes of the trunk as columns, (3, 3): left, up, front."""
    up, across = np.empty(3), np.empty(3)
    for i in range(3):
        left, right = joints_m[0, i] - joints_m[7, i], joints_m[1, i] - joints_m[6, i]
        up[i], across[i] = left + right, left - right
    trunk = np.empty((3, 3))
    trunk[:, 1] = _unit(up)
    trunk[:, 2] = _unit(_cross(across, trunk[:, 1]))
    trunk[:, 0] = _cross(trunk[:, 1], trunk[:, 2])
    return trunk


@compiled
def _set_limb(
    pose: Vector, start: Vector, middle: Vector, end: Vector, length: float, at: int, at_bend: int
) -> None:
    """Angles of shoulder and elbow, or hip and knee, from joints in the trunk's axes.

    Args:
        pose: Its angles of this limb are written.
        start: (3,) its root; then the joint where it bends and its end.
        length: Length of its upper part in the posed body.
        at: Index at which its angles begin.
        at_bend: Index of its bend, about the twisted axis of the upper part.
    """
    upper = _unit(middle - start)
    pose[at], pose[at + 2] = _aim(upper, at, pose)
    bend(pose, at, at_bend, _unit(end - start - length * upper))


@compiled
def bend(pose: Vector, at: int, at_bend: int, lower: Vector) -> None:
    """Set the twist of an upper limb and the bend of the lower one, so that the latter has a given
    direction.

    Args:
        pose: theta_X and theta_Z of the upper limb, pose[at] and pose[at + 2], are set.
        at: Index at which its angles begin.
        at_bend: Index of the bend: knees bend backwards, elbows forwards.
        lower: Unit vector in the trunk's axes.
    """
    across, along, front = _framed(lower, pose[at], pose[at + 2])
    bent, way = math.degrees(math.acos(cosine(along))), 1.0 if at_bend < HIP else -1.0
    if bent > STRAIGHT_DEG:
        pose[at + 1] = math.degrees(math.atan2(way * across, way * front))
        pose[at_bend] = way * bent
    else:
        turn = turn_deg(lower, pose, at)
        pose[at_bend] = turn if way > 0.0 else min(0.0, turn)


@compiled
def turn_deg(lower: Vector, pose: Vector, at: int) -> float:
    """Twist of a lower limb relative to its upper one, about that one's twisted axis."""
    across, along, front = _framed(lower, pose[at], pose[at + 2])
    twist = math.radians(pose[at + 1])
    return math.degrees(math.atan2(across * math.sin(twist) + front * math.cos(twist), along))


@compiled
def _unit(arrow: Vector) -> Floats:
    return arrow / max(math.sqrt(arrow[0] ** 2 + arrow[1] ** 2 + arrow[2] ** 2), 1e-9)


@compiled
def _cross(a: Vector, b: Vector) -> Floats:
    x = a[1] * b[2] - a[2] * b[1]
    return np.array([x, a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@compiled
def cosine(value: float) -> float:
    """The value without rounding errors."""
    return min(max(value, -1.0), 1.0)


@compiled
def _aim(axis: Vector, at: int, before: Vector) -> tuple[float, float]:
    """theta_X and theta_Z, degrees, that align a limb with an axis: of two solutions the
    likelier."""
    x = math.degrees(math.asin(cosine(axis[2])))
    z = math.degrees(math.atan2(-axis[0], axis[1]))
    one, other = (x, z % 360.0), ((180.0 - x + 180.0) % 360.0 - 180.0, (z + 180.0) % 360.0)
    if _cost(at, one[0], before) + _cost(at + 2, one[1], before) <= (
        _cost(at, other[0], before) + _cost(at + 2, other[1], before)
    ):
        return one
    return other


@compiled
def _cost(at: int, turn_deg: float, before: Vector) -> float:
    """Cost of a turn of a parameter, and of its excess over the limits."""
    low, high = LOW_DEG[at], HIGH_DEG[at]
    total = abs(apart(turn_deg, before[at]))
    if not low <= turn_deg <= high:
        total += ASTRAY * min(abs(apart(turn_deg, low)), abs(apart(turn_deg, high)))
    return total


@compiled
def apart(one_deg: float, other_deg: float) -> float:
    """Difference of two angles, in [-180, 180)."""
    return (one_deg - other_deg + 180.0) % 360.0 - 180.0


@compiled
def _framed(arrow: Vector, x_deg: float, z_deg: float) -> tuple[float, float, float]:
    """A vector in the trunk's axes, in the axes of a limb turned by R_z R_x."""
    a, b = math.radians(z_deg), math.radians(x_deg)
    across = math.cos(a) * arrow[0] + math.sin(a) * arrow[1]
    along = math.cos(a) * arrow[1] - math.sin(a) * arrow[0]
    front = math.cos(b) * arrow[2] - math.sin(b) * along
    return across, math.cos(b) * along + math.sin(b) * arrow[2], front
