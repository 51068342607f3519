"""From the picture's plane into the room: depth of every segment by scaled orthography (3.1.5)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, OTHER_SIDE, Vector
from common.notes.notes import Orientation

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}


class Lifted(NamedTuple):
    """A body in space: x to the right of the picture, y up, z to the camera; metres."""

    joints_m: NDArray[np.float64]
    """(15, 3), JOINT_NAMES, sides as the person's own; z is 0 at the pelvis, x and y are 0 at the
    corner of the picture."""
    tilt_deg: Vector
    """(10,): out of the picture's plane, positive towards the camera."""
    error_deg: Vector
    """(10,): by how much the tilt changes where the segment is a pixel longer or shorter."""
    yaw_deg: float
    """0 faces the camera, 90 the right of the picture."""


def depths_m(lengths_m: Vector, lengths_px: Vector, px_per_m: float) -> Vector:
    """How far apart in depth the ends of segments are, without the sign (n,).

    Source: Demir 2006, eq. (2.2), its radicand not below 0 (T19, M22).
    """
    depth: Vector = np.sqrt(np.maximum(lengths_m**2 - (lengths_px / px_per_m) ** 2, 0.0))
    return depth


def tilt_errors_deg(lengths_m: Vector, lengths_px: Vector, px_per_m: float) -> Vector:
    """What a pixel of length more or less does to the angle out of the plane, (n,): the larger."""
    longest_px = lengths_m * px_per_m

    def tilt_deg(length_px: Vector) -> Vector:
        angle: Vector = np.degrees(np.arccos(np.clip(length_px / longest_px, 0.0, 1.0)))
        return angle

    here = tilt_deg(lengths_px)
    off = [np.abs(tilt_deg(lengths_px + pixel) - here) for pixel in (-1.0, 1.0)]
    worse: Vector = np.maximum(off[0], off[1])
    return worse


def yaw_of(orientation: Orientation, breadth: float) -> float:
    """How far the body is turned about the vertical, degrees: 0 to the camera, 90 to the right.

    Args:
        orientation: One of the six.
        breadth: How much of its breadth the trunk shows: its horizontal foreshortening (T22).
    """
    if orientation in ("left", "right"):
        return 90.0 if orientation == "right" else -90.0
    turned_deg = math.degrees(math.acos(min(1.0, max(0.0, breadth))))
    if orientation.startswith("backward"):
        turned_deg = 180.0 - turned_deg
    return turned_deg if orientation.endswith("right") else -turned_deg


def lift(
    joints_px: NDArray[np.float64],
    breadth: float,
    lengths_m: Vector,
    px_per_m: float,
    signs: Vector,
    orientation: Orientation,
) -> Lifted:
    """The body in space that a fitted stick body is the picture of.

    Args:
        joints_px: (15, 2), JOINT_NAMES, r on the left of the picture (T10): the person's own sides
            are settled here, by the orientation (3.1.5).
        breadth: How much of its breadth the trunk shows.
        lengths_m: (13,) of LIMBS, then half the shoulders, their drop, half the hips.
        px_per_m: One scale for all parts, from the height standing (T20).
        signs: (10,) of LIMBS with the person's own sides, 1: far end nearer to the camera, -1.
        orientation: Which way the person faces.
    """
    backward = orientation.startswith("backward")
    pixels = joints_px[OTHER_SIDE] if backward else joints_px
    flat_m = pixels / px_per_m * np.array([1.0, -1.0])
    lengths_px = np.linalg.norm(pixels[LIMB_ENDS[:, 1]] - pixels[LIMB_ENDS[:, 0]], axis=1)
    depth_m = np.where(np.asarray(signs) < 0, -1.0, 1.0) * depths_m(
        lengths_m[:10], lengths_px, px_per_m
    )
    yaw_deg = yaw_of(orientation, breadth)
    z_m = np.zeros(len(JOINT_NAMES))
    leftwards = -math.sin(math.radians(yaw_deg))
    for limb, (near, far) in enumerate(LIMB_ENDS):
        z_m[far] = z_m[near] + depth_m[limb]
        if limb == 0:
            drop = lengths_m[11] / lengths_m[0] * depth_m[0]
            for side, sign in (("l", 1.0), ("r", -1.0)):
                z_m[_AT[f"{side}_shoulder"]] = z_m[far] - drop + sign * lengths_m[10] * leftwards
                z_m[_AT[f"{side}_hip"]] = sign * lengths_m[12] * leftwards
    tilt_deg = np.degrees(np.arcsin(np.clip(depth_m / lengths_m[:10], -1.0, 1.0)))
    errors_deg = tilt_errors_deg(lengths_m[:10], lengths_px, px_per_m)
    joints_m = np.concatenate([flat_m, z_m[:, None]], axis=1)
    return Lifted(joints_m, tilt_deg, errors_deg, yaw_deg)
