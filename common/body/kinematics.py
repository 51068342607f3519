"""From angles to places: the chain of coordinate systems from world to limb (section 2.2)."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import (
    ELBOW,
    HIP,
    KNEE,
    NECK,
    SHOULDER,
    TORSO_X,
    TORSO_Y,
    TORSO_Z,
    Floats,
    Vector,
)
from common.body.proportions import (
    ANKLE_ALONG,
    ELBOW_ALONG,
    HEAD_HEIGHT,
    HIP_ASIDE,
    HIPS_UP,
    KNEE_ALONG,
    SHOULDER_ASIDE,
    SHOULDER_INSET,
    SHOULDER_UP,
    TORSO_HEIGHT,
    WRIST_ALONG,
)
from common.compiled import compiled

TORSO, HEAD = 0, 1
ARM_LIMBS: Final = ((6, 8), (7, 9))
"""Upper and lower arm, right then left: places in LIMBS."""
LEG_LIMBS: Final = ((2, 4), (3, 5))
"""Upper and lower leg, right then left."""
ALL_LIMBS: Final = 0x3FF
"""Limbs as bits: bit i is LIMBS[i]."""

FRAME: Final = 12
"""A limb's frame: origin (3), then its rotation to the world row by row (9); +y is its axis."""

_UPPER: Final = sum(1 << chain[0] for chain in (*ARM_LIMBS, *LEG_LIMBS))
"""Upper arms and legs, as bits."""
_LENGTH_AT: Final = np.array([2, 5, 8, 11, 14, 17, 19, 21, 23, 25])
"""Where each limb's height stands in a body vector."""


@compiled
def _turn(frames: Floats, limb: int, angle_deg: float, one: int, other: int) -> None:
    """Multiply a limb's rotation by a turn that leads the axis `one` to the axis `other`."""
    if angle_deg == 0.0:
        return
    s, c = math.sin(math.radians(angle_deg)), math.cos(math.radians(angle_deg))
    for row in range(3, FRAME, 3):
        u, v = frames[limb, row + one], frames[limb, row + other]
        frames[limb, row + one] = c * u + s * v
        frames[limb, row + other] = c * v - s * u


@compiled
def _start(frames: Floats, parent: int, limb: int, x: float, y: float) -> None:
    """A limb's frame = its parent's, with its origin at the parent's point (x, y, 0)."""
    for i in range(3):
        row = 3 + 3 * i
        frames[limb, i] = frames[parent, i] + frames[parent, row] * x + frames[parent, row + 1] * y
    for i in range(3, FRAME):
        frames[limb, i] = frames[parent, i]


@compiled
def _hang_ball(frames: Floats, limb: int, x: float, y: float, pose: Vector, at: int) -> None:
    """M_N^S = T(x, y, 0) R_z R_x R_y with the angles pose[at : at + 3] = (x, y, z)."""
    _start(frames, TORSO, limb, x, y)
    _turn(frames, limb, pose[at + 2], 0, 1)
    _turn(frames, limb, pose[at], 1, 2)
    _turn(frames, limb, pose[at + 1], 2, 0)


@compiled
def _hang_hinge(frames: Floats, upper: int, length: float, angle_deg: float) -> None:
    """M_S^F = T(0, length, 0) R_x."""
    _start(frames, upper, upper + 2, 0.0, length)
    _turn(frames, upper + 2, angle_deg, 1, 2)


@compiled
def hang_limbs(body: Vector, pose: Vector, limbs: int, frames: Floats) -> None:
    """Write the frames of some limbs; the trunk's frame must be there already.

    Args:
        body: Body vector.
        pose: The 25 motion parameters.
        limbs: The limbs to place, as bits.
        frames: (10, FRAME); the rows of other limbs are left as they are.
    """
    if limbs >> HEAD & 1:
        _hang_ball(frames, HEAD, 0.0, body[TORSO_HEIGHT], pose, NECK)
    for side in range(2):
        sign = -1.0 if side == 0 else 1.0
        arm, leg = 6 + side, 2 + side
        if limbs >> arm & 1:
            x, y = sign * body[SHOULDER_ASIDE], body[SHOULDER_UP]
            _hang_ball(frames, arm, x, y, pose, SHOULDER + 3 * side)
        if limbs >> (arm + 2) & 1:
            _hang_hinge(frames, arm, body[_LENGTH_AT[arm]], pose[ELBOW + side])
        if limbs >> leg & 1:
            _hang_ball(frames, leg, sign * body[HIP_ASIDE], 0.0, pose, HIP + 3 * side)
        if limbs >> (leg + 2) & 1:
            _hang_hinge(frames, leg, body[_LENGTH_AT[leg]], pose[KNEE + side])


@compiled
def place_limbs(body: Vector, pose: Vector, limbs: int, frames: Floats) -> None:
    """Write the frames of some limbs into `frames` (10, FRAME).

    M_W^N = T R_y R_x (R_z innermost: the paper keeps it at 0), then M_N^S and M_S^F (P8).

    Args:
        body: Body vector.
        pose: The 25 motion parameters.
        limbs: The wanted limbs, as bits; a lower limb's upper limb is placed too.
        frames: (10, FRAME); row 0 is always written, rows of other limbs are left as they are.
    """
    for i in range(3):
        frames[TORSO, i] = pose[i]
    for i in range(9):
        frames[TORSO, 3 + i] = 1.0 if i % 4 == 0 else 0.0
    _turn(frames, TORSO, pose[TORSO_Y], 2, 0)
    _turn(frames, TORSO, pose[TORSO_X], 1, 2)
    _turn(frames, TORSO, pose[TORSO_Z], 0, 1)
    hang_limbs(body, pose, limbs | limbs >> 2 & _UPPER, frames)


def limb_frames(body: Vector, pose: Vector) -> Vector:
    """The frames of all ten limbs, (10, FRAME), world metres."""
    frames = np.empty((10, FRAME))
    place_limbs(body, pose, ALL_LIMBS, frames)
    return frames


def segments(body: Vector, pose: Vector) -> NDArray[np.float64]:
    """Both ends of each cylinder's axis, (10, 2, 3), world metres, in the order of LIMBS."""
    frames = limb_frames(body, pose)
    ends = frames[:, :3] + body[_LENGTH_AT][:, None] * frames[:, [4, 7, 10]]
    return np.stack([frames[:, :3], ends], axis=1)


@compiled
def joints(body: Vector, pose: Vector) -> Floats:
    """The 15 landmarks, (15, 3), world metres, in the order of JOINT_NAMES."""
    frames, out = np.empty((10, FRAME)), np.empty((15, 3))
    place_limbs(body, pose, ALL_LIMBS, frames)
    for i in range(3):
        across, up = frames[TORSO, 3 + 3 * i], frames[TORSO, 4 + 3 * i]
        out[0, i] = frames[TORSO, i] + body[HIPS_UP] * up
        out[1, i] = frames[TORSO, i] + body[TORSO_HEIGHT] * up
        out[2, i] = frames[HEAD, i] + body[HEAD_HEIGHT] * frames[HEAD, 4 + 3 * i]
        for side, at in ((1, 3), (0, 9)):
            arm, leg = 6 + side, 2 + side
            inwards = (body[SHOULDER_INSET] if side == 0 else -body[SHOULDER_INSET]) * across
            out[at, i] = frames[arm, i] + inwards
            out[at + 1, i] = _along(frames, body, arm, body[ELBOW_ALONG + side], i) + inwards
            out[at + 2, i] = _along(frames, body, arm, body[WRIST_ALONG + side], i) + inwards
            out[at + 3, i] = frames[leg, i] + body[HIPS_UP] * up
            out[at + 4, i] = _along(frames, body, leg, body[KNEE_ALONG + side], i)
            out[at + 5, i] = _along(frames, body, leg, body[ANKLE_ALONG + side], i)
    return out


@compiled
def _along(frames: Floats, body: Vector, upper: int, distance_m: float, i: int) -> float:
    """Coordinate i of the point at a given length along an upper limb and its lower limb."""
    beyond_m = distance_m - body[_LENGTH_AT[upper]]
    if beyond_m <= 0.0:
        return frames[upper, i] + distance_m * frames[upper, 4 + 3 * i]
    return frames[upper + 2, i] + beyond_m * frames[upper + 2, 4 + 3 * i]
