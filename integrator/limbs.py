"""From twelve joints to the angles of the ten cylinders: the way back through the kinematics."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body import LIMITS_DEG, POSE_INDEX, Vector

PLACES: Final = {
    f"{side}_{name}": 2 * i + (side == "r")
    for i, name in enumerate(("shoulder", "elbow", "wrist", "hip", "knee", "ankle"))
    for side in "lr"
}
"""Where each joint stands among the twelve."""

STRAIGHT_DEG: Final = 12.0
"""An arm that is bent less does not tell how it is twisted."""
ASTRAY: Final = 3.0
"""How much worse a degree beyond a joint's limits is than a degree from the pose before."""


def pose_of(joints_m: NDArray[np.float64], body: Vector, before: Vector) -> Vector:
    """The pose, (25,), that puts a body's landmarks where joints are, but for their lengths.

    Args:
        joints_m: (12, 3) world, in the order of PLACES.
        body: Body vector.
        before: Pose of the frame before: of two ways to the same place, the nearer one is taken.
    """
    at = {name: joints_m[i] for name, i in PLACES.items()}
    pose = before.copy()
    trunk = trunk_of(joints_m)
    _set(pose, "torso", _turns(trunk))
    hips = (at["l_hip"] + at["r_hip"]) / 2
    pose[:3] = hips - body[37] * trunk[:, 1]
    for i, side in enumerate("rl"):
        _arm(pose, [at[f"{side}_{n}"] @ trunk for n in ("shoulder", "elbow", "wrist")], body, i)
        _leg(pose, [at[f"{side}_{n}"] @ trunk for n in ("hip", "knee", "ankle")], body, i)
    return pose


def trunk_of(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes of the trunk as columns, (3, 3): left, up, front."""
    at = {name: joints_m[PLACES[name]] for name in ("l_shoulder", "r_shoulder", "l_hip", "r_hip")}
    up = at["l_shoulder"] + at["r_shoulder"] - at["l_hip"] - at["r_hip"]
    up /= np.linalg.norm(up)
    across = at["l_shoulder"] - at["r_shoulder"] + at["l_hip"] - at["r_hip"]
    front = np.cross(across, up)
    front /= np.linalg.norm(front)
    return np.stack([np.cross(up, front), up, front], axis=1)


def _turns(trunk: NDArray[np.float64]) -> Vector:
    """theta_X, theta_Y, theta_Z, degrees, of R_y R_x R_z."""
    x = -np.arcsin(np.clip(trunk[1, 2], -1.0, 1.0))
    y = np.arctan2(trunk[0, 2], trunk[2, 2])
    z = np.arctan2(trunk[1, 0], trunk[1, 1])
    return np.degrees([x, y, z])


def _set(pose: Vector, joint: str, turns_deg: Vector) -> None:
    for axis, turn in zip("xyz", turns_deg, strict=True):
        pose[POSE_INDEX[f"{joint}_{axis}"]] = turn


def _arm(pose: Vector, chain: list[Vector], body: Vector, i: int) -> None:
    """Shoulder and elbow of one arm, in the trunk's axes."""
    side, (shoulder, elbow, wrist) = "rl"[i], chain
    upper = _unit(elbow - shoulder)
    x, z = _aim(upper, f"{side}_shoulder", pose)
    lower = _unit(wrist - shoulder - body[19 + 2 * i] * upper)
    across, along, front = _framed(lower, x, z)
    bent = np.degrees(np.arccos(np.clip(along, -1.0, 1.0)))
    y_at, e_at = POSE_INDEX[f"{side}_shoulder_y"], POSE_INDEX[f"{side}_elbow_x"]
    if bent > STRAIGHT_DEG:
        y = np.degrees(np.arctan2(across, front))
        pose[y_at], pose[e_at] = y, bent
    else:
        twist = np.radians(pose[y_at])
        pose[e_at] = np.degrees(np.arctan2(across * np.sin(twist) + front * np.cos(twist), along))
    pose[POSE_INDEX[f"{side}_shoulder_x"]], pose[POSE_INDEX[f"{side}_shoulder_z"]] = x, z


def _leg(pose: Vector, chain: list[Vector], body: Vector, i: int) -> None:
    """Hip and knee of one leg, in the trunk's axes; the knee bends about the hip's twisted axis."""
    side, (hip, knee, ankle) = "rl"[i], chain
    start = hip - np.array([0.0, body[37], 0.0])
    upper = _unit(knee - start)
    x, z = _aim(upper, f"{side}_hip", pose)
    lower = _unit(ankle - start - body[8 + 3 * i] * upper)
    across, along, front = _framed(lower, x, z)
    bent = np.degrees(np.arccos(np.clip(along, -1.0, 1.0)))
    if bent > STRAIGHT_DEG:
        y = np.degrees(np.arctan2(-across, -front))
        pose[POSE_INDEX[f"{side}_hip_y"]] = y
        pose[POSE_INDEX[f"{side}_knee_x"]] = -bent
    else:
        twist = np.radians(pose[POSE_INDEX[f"{side}_hip_y"]])
        turn = np.degrees(np.arctan2(across * np.sin(twist) + front * np.cos(twist), along))
        pose[POSE_INDEX[f"{side}_knee_x"]] = min(0.0, turn)
    pose[POSE_INDEX[f"{side}_hip_x"]], pose[POSE_INDEX[f"{side}_hip_z"]] = x, z


def _unit(arrow: Vector) -> Vector:
    found: Vector = arrow / max(float(np.linalg.norm(arrow)), 1e-9)
    return found


def _aim(axis: Vector, joint: str, before: Vector) -> tuple[float, float]:
    """theta_X and theta_Z, degrees, that lead a limb along an axis: of two ways the likelier."""
    x = float(np.degrees(np.arcsin(np.clip(axis[2], -1.0, 1.0))))
    z = float(np.degrees(np.arctan2(-axis[0], axis[1])))
    ways = [(x, z % 360.0), ((180.0 - x + 180.0) % 360.0 - 180.0, (z + 180.0) % 360.0)]

    def cost(way: tuple[float, float]) -> float:
        total = 0.0
        for name, turn in zip("xz", way, strict=True):
            low, high = LIMITS_DEG[f"{joint}_{name}"]
            total += abs(_apart(turn, before[POSE_INDEX[f"{joint}_{name}"]]))
            total += (
                ASTRAY
                * min(abs(_apart(turn, low)), abs(_apart(turn, high)))
                * (not low <= turn <= high)
            )
        return total

    return min(ways, key=cost)


def _apart(one_deg: float, other_deg: float) -> float:
    return float((one_deg - other_deg + 180.0) % 360.0 - 180.0)


def _framed(arrow: Vector, x_deg: float, z_deg: float) -> Vector:
    """An arrow of the trunk's axes in those of a limb turned by R_z R_x."""
    a, b = np.radians(z_deg), np.radians(x_deg)
    z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    found: Vector = (z @ x).T @ arrow
    return found
