"""The lean of segments and the facing, which one view cannot measure (T21, T22)."""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body import stick_body
from common.body.body import LIMB_ENDS, LIMBS, Vector
from common.notes.notes import Orientation
from integrator.single.lifting import StickPicture, depths_m, yaw_of
from integrator.single.orientation import Bearing, faced

CHAINS: Final = np.array([(stick_body.TORSO, stick_body.HEAD), *stick_body.CHAINS])
"""Chains in LIMBS: torso and head, arms, legs. Signs are chosen for the two segments of a chain
together."""
WAYS: Final = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
"""Possible signs of a chain's two segments."""

SOFTNESS: Final = 0.25
"""Cost difference that means odds of e to 1."""
MOTION: Final = 2.0
"""Cost of a segment whose direction is 1 (60 degrees) off the one that its motion predicts."""
MOMENTUM: Final = 0.8
"""Share of a segment's last turn that is predicted to continue."""
FORWARDS: Final = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0])
"""Usual lean of each of LIMBS: to the front, but lower legs to the back."""
LEANING: Final = 0.05
"""Cost of the other lean: it decides where nothing else does."""


class Memory(NamedTuple):
    """Memory of the body before."""

    directions: NDArray[np.float64] | None
    """(10, 3) of LIMBS, unit: direction of each segment; None: unknown."""
    turning: NDArray[np.float64]
    """(10, 3): its change since the frame before."""
    bearing: Bearing


class Choice(NamedTuple):
    """Signs and orientation, with their confidence."""

    signs: Vector
    """(10,) of LIMBS, the person's own sides: 1 far end towards the camera, -1 away."""
    confidence: Vector
    """(10,) in [0, 1]; 1 where the user set it."""
    orientation: Orientation
    orientation_confidence: float
    bearing: Bearing
    """The orientation's state after this frame, before any input of the user."""


def init() -> Memory:
    """The initial state."""
    return Memory(None, np.zeros((len(LIMBS), 3)), Bearing())


def directions_of(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direction of each of LIMBS, (10, 3), unit vectors, from joints (15, 3)."""
    along = joints_m[LIMB_ENDS[:, 1]] - joints_m[LIMB_ENDS[:, 0]]
    unit: NDArray[np.float64] = along / np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
    return unit


def choose(
    memory: Memory,
    picture: StickPicture,
    depth: Mapping[str, str] | None = None,
    orientation: Orientation | None = None,
) -> Choice:
    """Signs and orientation: the user's where given, else those of least cost by motion and limits.

    Args:
        memory: Of the frame before.
        picture: The stick body's.
        depth: The user's input: names of LIMBS to `toward` or `away`.
        orientation: The user's input.
    """
    bearing = faced(memory.bearing, picture.joints_px, picture.breadth)
    facing = orientation or bearing.orientation
    pixels, px_per_m = picture.of_own_sides(facing), picture.px_per_m
    flat_m = (pixels[LIMB_ENDS[:, 1]] - pixels[LIMB_ENDS[:, 0]]) / px_per_m * np.array([1.0, -1.0])
    lengths_px = np.linalg.norm(flat_m, axis=1) * px_per_m
    deep_m = depths_m(picture.lengths_m[: len(LIMBS)], lengths_px, px_per_m)
    yaw = math.radians(yaw_of(facing, picture.breadth))
    costs = _costs(memory, flat_m, deep_m, np.array([math.sin(yaw), 0.0, math.cos(yaw)]))
    costs += _forbidden(depth or {})
    odds = np.exp((costs.min(axis=0) - costs) / SOFTNESS)
    best = costs.argmin(axis=0)
    signs, confidence = np.ones(len(LIMBS)), np.ones(len(LIMBS))
    for n, chain in enumerate(CHAINS):
        signs[chain] = WAYS[best[n]]
        same = WAYS[best[n]] == WAYS
        confidence[chain] = (odds[:, n, None] * same).sum(axis=0) / odds[:, n].sum()
    return Choice(signs, confidence, facing, 1.0 if orientation else bearing.confidence, bearing)


def remembered(memory: Memory, joints_m: NDArray[np.float64], choice: Choice) -> Memory:
    """The memory after a frame that one view settled.

    Args:
        memory: Before it.
        joints_m: (15, 3), as lifted.
        choice: The choice for that frame.
    """
    bearing = choice.bearing._replace(
        orientation=choice.orientation, confidence=choice.orientation_confidence
    )
    return _next(memory, joints_m, bearing)


def witnessed(
    memory: Memory, joints_m: NDArray[np.float64], orientation: Orientation, confidence: float
) -> Memory:
    """The memory after a frame whose body was not lifted.

    Args:
        memory: Before it.
        joints_m: (15, 3), as in `Lifted`.
        orientation: The facing.
        confidence: Confidence in it.
    """
    return _next(memory, joints_m, Bearing(orientation, confidence))


def _next(memory: Memory, joints_m: NDArray[np.float64], bearing: Bearing) -> Memory:
    now = directions_of(joints_m)
    before = now if memory.directions is None else memory.directions
    return Memory(now, now - before, bearing)


def _costs(memory: Memory, flat_m: Vector, deep_m: Vector, forward: Vector) -> Vector:
    """Cost of each of WAYS for each of CHAINS, (4, 5)."""
    size = np.maximum(np.sqrt((flat_m**2).sum(axis=1) + deep_m**2), 1e-9)[:, None]
    toward = np.concatenate([flat_m, deep_m[:, None]], axis=1) / size
    way = np.stack([toward, toward * np.array([1.0, 1.0, -1.0])])
    leaning = -LEANING * np.outer([1.0, -1.0], FORWARDS) * forward[2]
    if memory.directions is not None:
        expected = memory.directions + MOMENTUM * memory.turning
        leaning += MOTION * ((way - expected) ** 2).sum(axis=2)
    picked = (WAYS < 0).astype(int)
    upper, lower = (way[picked[:, [i]], CHAINS[:, i]] for i in (0, 1))
    costs = sum(leaning[picked[:, [i]], CHAINS[:, i]] for i in (0, 1))
    ahead, below = upper @ forward, lower @ forward
    bend = below - (lower * upper).sum(axis=2) * ahead
    return np.asarray(costs + _strain(ahead, bend))


def _strain(ahead: Vector, bend: Vector) -> Vector:
    """Cost of impossible bends, (4, 5): from how far each upper segment points to the front, and
    how far its lower one bends to the front from it.

    People bow forwards, arms reach back by 40 degrees and elbows bend forwards, hips reach back by
    20 and knees bend backwards.
    """
    back = np.maximum(0.0, -ahead)
    strain = 0.2 * back
    strain[:, 0] += 0.8 * back[:, 0]
    strain[:, 1:3] += np.maximum(0.0, back[:, 1:3] - 0.6) + np.maximum(0.0, -bend[:, 1:3] - 0.1)
    strain[:, 3:] += 2.0 * np.maximum(0.0, back[:, 3:] - 0.3)
    strain[:, 3:] += 2.0 * np.maximum(0.0, bend[:, 3:] - 0.1)
    return strain


def _forbidden(depth: Mapping[str, str]) -> Vector:
    """Infinite costs for what the user excluded, (4, 5)."""
    costs = np.zeros((len(WAYS), len(CHAINS)))
    for name, said in depth.items():
        n, i = (int(at[0]) for at in np.nonzero(np.equal(CHAINS, LIMBS.index(name))))
        costs[WAYS[:, i] != (1.0 if said == "toward" else -1.0), n] = np.inf
    return costs
