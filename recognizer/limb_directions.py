"""The richer feature vector: how all limbs point, and how the body as a whole moves."""

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLE_INDEX
from common.compiled import compiled
from recognizer.features import ROW_NAMES, Rows

Bearings = NDArray[np.float64]
"""Feature vectors: (n, 27), BEARING_NAMES order."""

CHAINS: Final = (
    ("r_shoulder", "r_elbow"),
    ("l_shoulder", "l_elbow"),
    ("r_hip", "r_knee"),
    ("l_hip", "l_knee"),
)
"""The upper joint of each arm and leg, and the hinge below it."""

BEARING_NAMES: Final = (
    *(f"{joint}_{axis}" for chain in CHAINS for joint in chain for axis in "xyz"),
    *(f"travel_{axis}" for axis in "xyz"),
)
"""The order of a vector; a model says for which order it was trained."""

TRAVEL_POSES: Final = 5
"""Travel is the way since so many poses before: a third of a second, half a step."""
TRAVEL_WEIGHT: Final = 2.0
"""Travel varies less than directions do: so weighted, a floor of variance fits both."""

_TURNS: Final = np.array(
    [
        [ANGLE_INDEX[f"{upper}_{axis}"] for axis in "xyz"] + [ANGLE_INDEX[f"{hinge}_x"]]
        for upper, hinge in CHAINS
    ]
)
"""Columns of each chain's four angles."""
_YAW: Final = ANGLE_INDEX["torso_y"]
_ROOT: Final = ROW_NAMES.index("root_x")


def bearings(given: Rows) -> Bearings:
    """The feature vectors of rows with a pose, (n, 27).

    A direction is a limb's own axis in the body's frame; travel is seen from the body: to its
    side, up, and ahead. Without travel no model could tell walking towards somebody
    from walking in place: limbs alone are all that the paper's ten angles speak of.

    Source: section 2.2 (M_N^S, M_S^F: C3, C4) for the directions.
    """
    shown = np.empty((len(given), len(BEARING_NAMES)))
    for chain, turns in enumerate(_TURNS):
        _point(given[:, turns], shown[:, 6 * chain : 6 * chain + 6])
    _move(given[:, _ROOT:], given[:, _YAW], shown[:, -3:])
    return shown


@compiled
def _point(turns_deg: Any, shown: Any) -> None:
    """Write R_z R_x (0, 1, 0) and R_z R_x R_y R_hinge (0, 1, 0), side by side."""
    for row in range(len(turns_deg)):
        x, y, z, hinge = np.radians(turns_deg[row])
        ahead = math.sin(hinge) * math.cos(y)
        side, along = math.sin(hinge) * math.sin(y), math.cos(hinge)
        up = along * math.cos(x) - ahead * math.sin(x)
        shown[row, 0] = -math.sin(z) * math.cos(x)
        shown[row, 1] = math.cos(z) * math.cos(x)
        shown[row, 2] = math.sin(x)
        shown[row, 3] = side * math.cos(z) - up * math.sin(z)
        shown[row, 4] = side * math.sin(z) + up * math.cos(z)
        shown[row, 5] = along * math.sin(x) + ahead * math.cos(x)


@compiled
def _move(root: Any, yaw_deg: Any, shown: Any) -> None:
    """Write the weighted way of the root since TRAVEL_POSES poses before, or since the first, in
    the body's frame."""
    for row in range(len(root)):
        way = TRAVEL_WEIGHT * (root[row] - root[max(row - TRAVEL_POSES, 0)])
        s, c = math.sin(math.radians(yaw_deg[row])), math.cos(math.radians(yaw_deg[row]))
        shown[row, 0] = c * way[0] - s * way[2]
        shown[row, 1] = way[1]
        shown[row, 2] = s * way[0] + c * way[2]
