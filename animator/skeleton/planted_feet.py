"""Feet that do not slide: a standing foot is held in place, and the body follows by its bones."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.skeleton.bones import Joints, Skeleton
from animator.skeleton.fitted_bones import fitted
from animator.skeleton.foot_contact import SIDES, Stance, stances
from common.body.body import Vector
from common.body.extremities import ALL_JOINT_NAMES

Floats = NDArray[np.float64]

BLEND_S: Final = 0.2
"""Seconds before and after a contact in which a foot moves to its measured place."""
STANDS_FAST: Final = np.array([300.0, 3.0, 300.0])
"""Resistance of a standing foot's ankle along each axis, relative to other joints: infinite
along the floor, moderate vertically. Its tracked height varies by 8 mm, and a straight leg that
is a centimetre too long bends by 18 degrees. Chosen on two performers (docs/measurements.md)."""
HIP: Final = 3.0
"""Resistance of a hip, relative to other joints: both carry the pelvis and all above."""

_AT: Final = {name: i for i, name in enumerate(ALL_JOINT_NAMES)}


class Planted(NamedTuple):
    """A run whose feet do not slide."""

    joints_m: Joints
    held: Floats
    """(n, 2) of the left and the right foot: 1 while it stands, less during the transitions."""


def planted(joints_m: Joints, time_s: Vector) -> Planted:
    """The run with each standing foot at its median place.

    Args:
        joints_m: (n, 15 or 22, 3), NaN where there is no pose.
        time_s: (n,) increasing.
    """
    moved, held = joints_m.copy(), np.zeros((len(joints_m), 2))
    if len(joints_m) < 2:
        return Planted(moved, held)
    found = stances(joints_m, time_s)
    for foot, side in enumerate(SIDES):
        own = [stance for stance in found if stance.side == side]
        held[:, foot] = _weights(own, time_s)
        for part in ("ankle", "heel", "toe"):
            at = _AT[f"{side}_{part}"]
            if at < joints_m.shape[1]:
                moved[:, at] += _shifts(joints_m[:, at], own, held[:, foot])
    return Planted(moved, held)


def on_its_feet(skeleton: Skeleton, run: Planted) -> Joints:
    """The joints to which a skeleton of fixed bones is aimed so that its feet do not slide either.

    Args:
        skeleton: The run's skeleton.
        run: Rows with a pose.
    """
    weights = np.ones_like(run.joints_m)
    for foot, side in enumerate(SIDES):
        weights[:, _AT[f"{side}_hip"]] = HIP
        weights[:, _AT[f"{side}_ankle"]] += run.held[:, foot, None] * STANDS_FAST
    return fitted(skeleton, run.joints_m, weights)


def _weights(own: list[Stance], time_s: Vector) -> Vector:
    """(n,) 1 in a stance, falling to 0 within BLEND_S beside it."""
    weights = np.zeros(len(time_s))
    for stance in own:
        first_s, last_s = time_s[stance.first], time_s[stance.end - 1]
        rows = slice(*np.searchsorted(time_s, (first_s - BLEND_S, last_s + BLEND_S)))
        since = np.maximum(first_s - time_s[rows], time_s[rows] - last_s)
        fall = np.clip(1.0 - np.maximum(since, 0.0) / BLEND_S, 0.0, 1.0)
        weights[rows] = np.maximum(weights[rows], fall * fall * (3.0 - 2.0 * fall))
    return weights


def _shifts(places_m: Floats, own: list[Stance], weights: Vector) -> Floats:
    """Displacement of a point of a foot, (n, 3)."""
    stands, shifts = np.zeros(len(places_m), np.bool_), np.zeros_like(places_m)
    for stance in own:
        part = slice(stance.first, stance.end)
        stands[part] = True
        shifts[part] = np.median(places_m[part], axis=0) - places_m[part]
    if not own:
        return shifts
    rows = nearest(np.arange(len(places_m)), np.flatnonzero(stands))
    return np.asarray(weights[:, None] * shifts[rows])


def nearest(rows: NDArray[np.int64], known: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each of `rows` (n,) the nearest of `known` (k,), the earlier of two at one distance.

    Args:
        rows: In any order.
        known: Increasing, at least one.
    """
    at = np.searchsorted(known, rows)
    before, after = known[(at - 1).clip(min=0)], known[at.clip(max=len(known) - 1)]
    return np.asarray(np.where(np.abs(rows - before) <= np.abs(after - rows), before, after))
