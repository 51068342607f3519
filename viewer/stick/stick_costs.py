"""Costs of a stick pose besides its match: fast motion, unseen depth, impossible bends."""

from typing import Final

import numpy as np

from common.body.body import Floats, Vector
from common.body.stick_body import ANGLE, BREADTH, GIRTH, HEAD, RATIO, STATURE, TORSO
from common.compiled import compiled

(
    TIME,
    TRUNK_TILT,
    LEG_TILT,
    ARM_TILT,
    BREADTH_CHANGE,
    STATURE_CHANGE,
    LEAN,
    BEND,
    CROSS,
    GIRTH_CHANGE,
) = range(10)

COSTS: Final = np.array([0.006, 0.06, 0.02, 0.02, 0.2, 10.0, 0.01, 0.012, 1.0, 0.5])
"""Weights of these costs, in S. A limb's swing: per change of 1 in its direction vector since
the prediction (60 degrees). Depth: trunk, legs or arms out of the plane of the picture. Change
of breadth and of stature: by all they are. Lean of the trunk: 90 degrees. Bends: an elbow by 90
degrees in the plane, a knee where the trunk shows its breadth. Crossing: a knee or foot seen
from the front on the other side, by a stature. Chosen on two performers, each halved and doubled
(docs/measurements.md)."""

TILTED: Final = 0.15
"""1 - ratio^2 at which a limb out of the plane has half its full cost (23 degrees). So invisible
depth stays 0, while a visible depth may grow."""

STIFF_NECK: Final = 3.0
"""Cost of a neck's bend in the plane, over an elbow's."""


@compiled
def limb_cost(pose: Vector, expected: Vector, limb: int, trust: float, costs: Vector) -> float:
    """Cost of a limb's place: its turn in space since the prediction, and its depth.

    The sign of the depth does not matter here, so the turn is taken to the nearer one.
    """
    a, b = np.radians(pose[ANGLE + limb]), np.radians(expected[ANGLE + limb])
    r, e = min(pose[RATIO + limb], 1.0), min(expected[RATIO + limb], 1.0)
    dx, dy = r * np.cos(a) - e * np.cos(b), r * np.sin(a) - e * np.sin(b)
    dz = np.sqrt(1.0 - r * r) - np.sqrt(1.0 - e * e)
    moved = trust * costs[TIME] * (dx * dx + dy * dy + 0.25 * dz * dz)
    off = 1.0 - r * r
    which = TRUNK_TILT if limb == TORSO else LEG_TILT if limb < 6 else ARM_TILT
    return moved + costs[which] * off / (off + TILTED)


@compiled
def bend_cost(pose: Vector, upper: int, costs: Vector) -> float:
    """Cost of the bend of an elbow or a knee, as far as it lies in the plane."""
    bend = np.radians(pose[ANGLE + upper + 2] - pose[ANGLE + upper])
    share = costs[BEND] * pose[RATIO + upper] * pose[RATIO + upper + 2] * (1.0 - np.cos(bend))
    return share if upper >= 6 else share * pose[BREADTH]


@compiled
def cross_cost(ends: Floats, pose: Vector, costs: Vector) -> float:
    """Cost of knees and feet on the wrong sides."""
    wrong = 0.0
    for limb in (2, 4):
        wrong += max(0.0, ends[limb, 2] - ends[limb + 1, 2])
    return costs[CROSS] * pose[BREADTH] * wrong / pose[STATURE]


@compiled
def pose_cost(pose: Vector, ends: Floats, expected: Vector, trust: float, costs: Vector) -> float:
    """Cost of a whole pose; `ends` are its segments."""
    wider, taller = pose[BREADTH] - expected[BREADTH], pose[STATURE] / expected[STATURE] - 1.0
    total = costs[BREADTH_CHANGE] * wider * wider + costs[STATURE_CHANGE] * taller * taller
    thicker = pose[GIRTH] - expected[GIRTH]
    total += costs[GIRTH_CHANGE] * trust * thicker * thicker
    lean = np.cos(np.radians(pose[ANGLE]))
    total += costs[LEAN] * lean * lean + cross_cost(ends, pose, costs)
    for limb in range(10):
        total += limb_cost(pose, expected, limb, trust, costs)
    nod = np.radians(pose[ANGLE + HEAD] - pose[ANGLE])
    total += STIFF_NECK * costs[BEND] * (1.0 - np.cos(nod))
    for upper in (2, 3, 6, 7):
        total += bend_cost(pose, upper, costs)
    return total
