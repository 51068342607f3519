"""Which way every segment leans and the body faces: what a single view cannot measure (T21, T22)."""

import itertools
import math
from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body import LIMBS, Vector
from integrator.lifting import ENDS, ORIENTATIONS, SWAPPED_LIMBS, Lifted, Orientation, lift, yaw_of

CHAINS: Final = ((6, 8), (7, 9), (2, 4), (3, 5))
SOFTNESS: Final = 0.25
"""Costs that differ by this leave odds of e to 1."""


class Memory(NamedTuple):
    """What is remembered of the body before."""

    directions: NDArray[np.float64] | None
    """(10, 3) of LIMBS, unit: where each segment pointed; None: nothing is known."""
    turning: NDArray[np.float64] | None
    """(10, 3): how that changed by the frame before it."""
    orientation: Orientation
    sure: float
    """How sure the orientation is, in [0, 1]."""


class Choice(NamedTuple):
    """Signs and orientation, with how sure they are."""

    signs: Vector
    """(10,) of LIMBS, the person's own sides: 1 towards the camera, -1 away."""
    confidence: Vector
    """(10,) in [0, 1]."""
    orientation: Orientation
    orientation_confidence: float


def init() -> Memory:
    """Nothing is known: people are filmed from the front more often than not."""
    return Memory(None, None, "forward_right", 0.5)


def directions_of(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where each of LIMBS points, (10, 3), unit vectors."""
    along = joints_m[ENDS[:, 1]] - joints_m[ENDS[:, 0]]
    unit: NDArray[np.float64] = along / np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
    return unit


def remembered(memory: Memory, joints_m: NDArray[np.float64], choice: Choice) -> Memory:
    """The memory after a pose that was settled, from one view or from two."""
    now = directions_of(joints_m)
    turning = None if memory.directions is None else now - memory.directions
    return Memory(now, turning, choice.orientation, choice.orientation_confidence)


def choose(
    memory: Memory,
    joints_px: NDArray[np.float64],
    breadth: float,
    lengths_m: Vector,
    px_per_m: float,
    depth: Mapping[str, str] | None = None,
    orientation: Orientation | None = None,
) -> Choice:
    """Signs and orientation: the user's where given, else the least cost of motion and limits.

    Args:
        memory: Of the frame before, or of the last pose that two views settled.
        joints_px: As for `lift`, likewise `breadth`, `lengths_m`, `px_per_m`.
        depth: The user's: LIMBS name to toward or away.
        orientation: The user's.
    """
    facing = orientation or memory.orientation
    sure = 1.0 if orientation else memory.sure
    towards = lift(joints_px, breadth, lengths_m, px_per_m, np.ones(10), facing)
    away = lift(joints_px, breadth, lengths_m, px_per_m, -np.ones(10), facing)
    tilt = np.radians(np.abs(towards.tilt_deg))
    flat = directions_of(towards.joints_m) * np.array([1.0, 1.0, 0.0])
    flat /= np.maximum(np.linalg.norm(flat, axis=1), 1e-9)[:, None]
    both = np.stack([flat * np.cos(tilt)[:, None], flat * np.cos(tilt)[:, None]])
    both[0, :, 2], both[1, :, 2] = -np.sin(tilt), np.sin(tilt)
    yaw = math.radians(yaw_of(facing, breadth))
    forward = np.array([math.sin(yaw), 0.0, math.cos(yaw)])
    signs, confidence = np.ones(10), np.ones(10)
    held = {LIMBS.index(name): 1 if way == "toward" else 0 for name, way in (depth or {}).items()}
    for chain in ((0, 1), *CHAINS):
        costs = {}
        for picked in itertools.product((0, 1), repeat=2):
            if any(held.get(limb, way) != way for limb, way in zip(chain, picked, strict=True)):
                continue
            pair = [both[way, limb] for limb, way in zip(chain, picked, strict=True)]
            costs[picked] = _cost(memory, chain, pair, forward)
        least = min(costs.values())
        odds = {picked: math.exp((least - cost) / SOFTNESS) for picked, cost in costs.items()}
        best = min(costs, key=costs.__getitem__)
        for place, limb in enumerate(chain):
            signs[limb] = 1.0 if best[place] else -1.0
            same = sum(o for picked, o in odds.items() if picked[place] == best[place])
            confidence[limb] = same / sum(odds.values())
    return Choice(signs, confidence, facing, sure)


def _cost(
    memory: Memory, chain: tuple[int, int], pair: list[NDArray[np.float64]], forward: Vector
) -> float:
    cost = 0.0
    if memory.directions is not None:
        for limb, direction in zip(chain, pair, strict=True):
            expected = memory.directions[limb]
            if memory.turning is not None:
                expected = expected + 0.5 * memory.turning[limb]
            cost += 2.0 * float(np.sum((direction - expected) ** 2))
    upper, lower = pair
    bend = float(forward @ (lower - (lower @ upper) * upper))
    ahead = float(forward @ upper)
    if chain[0] == 0:  # people bow forwards
        return cost + max(0.0, -ahead) + 0.2 * max(0.0, -float(forward @ lower))
    if chain[0] in (2, 3):  # hips bend forwards, knees backwards
        return (
            cost
            + 2.0 * max(0.0, -ahead - 0.3)
            + 0.3 * max(0.0, -ahead)
            + 2.0 * max(0.0, bend - 0.1)
        )
    return (
        cost + 1.0 * max(0.0, -ahead - 0.6) + 0.2 * max(0.0, -ahead) + 1.0 * max(0.0, -bend - 0.1)
    )
