"""From the picture's plane into space: depth of every segment by scaled orthography (3.1.5)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, OTHER_SIDE, Vector
from common.body.stick_body import HALF_HIPS, HALF_SHOULDERS, SHOULDERS_BELOW, TORSO
from common.notes.notes import Orientation

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}


class StickPicture(NamedTuple):
    """A fitted stick body, and the proportions of the body that it shows."""

    joints_px: NDArray[np.float64]
    """(15, 2), JOINT_NAMES, r on the left of the picture (T10)."""
    breadth: float
    """Visible share of the trunk's breadth."""
    lengths_m: Vector
    """(13,) of LIMBS, then half the shoulders, their drop, half the hips."""
    px_per_m: float
    """One scale for all parts, from the standing height (T20)."""

    def of_own_sides(self, orientation: Orientation) -> NDArray[np.float64]:
        """The joints with the person's own sides, which the orientation settles (3.1.5)."""
        backward = orientation.startswith("backward")
        return self.joints_px[OTHER_SIDE] if backward else self.joints_px.copy()


class Lifted(NamedTuple):
    """A body in space: x to the right of the picture, y up, z to the camera; metres."""

    joints_m: NDArray[np.float64]
    """(15, 3), JOINT_NAMES, the person's own sides; z is 0 at the pelvis, x and y are 0 at the
    corner of the picture."""
    tilt_deg: Vector
    """(10,): angle out of the picture's plane, positive towards the camera."""
    error_deg: Vector
    """(10,): change of that angle with a pixel of the segment's length."""
    yaw_deg: float
    """0 faces the camera, 90 the right of the picture."""


def depths_m(lengths_m: Vector, lengths_px: Vector, px_per_m: float) -> Vector:
    """Depth difference of the ends of segments, without the sign (n,).

    Source: Demir 2006, eq. (2.2), its radicand not below 0 (T19, M22).
    """
    depth: Vector = np.sqrt(np.maximum(lengths_m**2 - (lengths_px / px_per_m) ** 2, 0.0))
    return depth


def tilt_errors_deg(lengths_m: Vector, lengths_px: Vector, px_per_m: float) -> Vector:
    """Change of the angle out of the plane with a pixel more or less of length, (n,): the
    larger."""
    longest_px = lengths_m * px_per_m

    def tilt_deg(length_px: Vector) -> Vector:
        angle: Vector = np.degrees(np.arccos(np.clip(length_px / longest_px, 0.0, 1.0)))
        return angle

    here = tilt_deg(lengths_px)
    off = [np.abs(tilt_deg(lengths_px + pixel) - here) for pixel in (-1.0, 1.0)]
    worse: Vector = np.maximum(off[0], off[1])
    return worse


def yaw_of(orientation: Orientation, breadth: float) -> float:
    """Turn of the body about the vertical, degrees: 0 to the camera, 90 to the right.

    Args:
        orientation: One of the six.
        breadth: Visible share of the trunk's breadth: its horizontal foreshortening (T22).
    """
    if orientation in ("left", "right"):
        return 90.0 if orientation == "right" else -90.0
    turned_deg = math.degrees(math.acos(min(1.0, max(0.0, breadth))))
    if orientation.startswith("backward"):
        turned_deg = 180.0 - turned_deg
    return turned_deg if orientation.endswith("right") else -turned_deg


def lift(picture: StickPicture, signs: Vector, orientation: Orientation) -> Lifted:
    """The body in space whose picture is a fitted stick body.

    Args:
        picture: The stick body's.
        signs: (10,) of LIMBS with the person's own sides, 1: far end nearer to the camera, -1.
        orientation: The person's facing.
    """
    pixels = picture.of_own_sides(orientation)
    limbs_m = picture.lengths_m[: len(LIMBS)]
    flat_m = pixels / picture.px_per_m * np.array([1.0, -1.0])
    lengths_px = np.linalg.norm(pixels[LIMB_ENDS[:, 1]] - pixels[LIMB_ENDS[:, 0]], axis=1)
    sizes_m = depths_m(limbs_m, lengths_px, picture.px_per_m)
    depth_m = np.where(np.asarray(signs) < 0, -1.0, 1.0) * sizes_m
    yaw_deg = yaw_of(orientation, picture.breadth)
    z_m = _before_m(picture.lengths_m, depth_m, yaw_deg)
    tilt_deg = np.degrees(np.arcsin(np.clip(depth_m / limbs_m, -1.0, 1.0)))
    errors_deg = tilt_errors_deg(limbs_m, lengths_px, picture.px_per_m)
    joints_m = np.concatenate([flat_m, z_m[:, None]], axis=1)
    return Lifted(joints_m, tilt_deg, errors_deg, yaw_deg)


def _before_m(lengths_m: Vector, depth_m: Vector, yaw_deg: float) -> Vector:
    """Distance of each joint in front of the pelvis, towards the camera, (15,)."""
    z_m = np.zeros(len(JOINT_NAMES))
    leftwards = -math.sin(math.radians(yaw_deg))
    for limb, (near, far) in enumerate(LIMB_ENDS):
        z_m[far] = z_m[near] + depth_m[limb]
        if limb != TORSO:
            continue
        drop_m = lengths_m[SHOULDERS_BELOW] / lengths_m[TORSO] * depth_m[TORSO]
        for side, sign in (("l", 1.0), ("r", -1.0)):
            aside_m = sign * lengths_m[HALF_SHOULDERS] * leftwards
            z_m[_AT[f"{side}_shoulder"]] = z_m[far] - drop_m + aside_m
            z_m[_AT[f"{side}_hip"]] = sign * lengths_m[HALF_HIPS] * leftwards
    return z_m
