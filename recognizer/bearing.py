"""The richer feature vector: how all limbs point, and how the body as a whole moves."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body import ANGLE_INDEX
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

_UPPER_X, _UPPER_Y, _UPPER_Z = (
    [ANGLE_INDEX[f"{upper}_{axis}"] for upper, _ in CHAINS] for axis in "xyz"
)
_HINGE: Final = [ANGLE_INDEX[f"{hinge}_x"] for _, hinge in CHAINS]
_YAW: Final = ANGLE_INDEX["torso_y"]
_ROOT: Final = slice(ROW_NAMES.index("root_x"), ROW_NAMES.index("root_z") + 1)


def bearings(given: Rows) -> Bearings:
    """The feature vectors of rows with a pose, (n, 27).

    A direction is a limb's own axis in the body's frame; travel is seen from the body: to its
    side, up, and ahead. Without travel no model could tell walking towards somebody
    from walking in place: limbs alone are all that the paper's ten angles speak of.

    Source: section 2.2 (M_N^S, M_S^F: C3, C4) for the directions.
    """
    directions = np.stack(_directions(given), axis=2).reshape(len(given), len(CHAINS) * 6)
    return np.concatenate([directions, TRAVEL_WEIGHT * _travel(given)], axis=1)


def _directions(given: Rows) -> list[NDArray[np.float64]]:
    """x, y and z, each (n, 8), of R_z R_x (0, 1, 0) and R_z R_x R_y R_hinge (0, 1, 0), chain by
    chain."""
    turns = np.radians(given[:, [*_UPPER_X, *_UPPER_Y, *_UPPER_Z, *_HINGE]])
    sines, cosines = (part.reshape(-1, 4, 4) for part in (np.sin(turns), np.cos(turns)))
    (sx, sy, sz, sh), (cx, cy, cz, ch) = sines.transpose(1, 0, 2), cosines.transpose(1, 0, 2)
    ahead = sh * cy
    side, up = sh * sy, ch * cx - ahead * sx
    upper = (-sz * cx, cz * cx, sx)
    lower = (side * cz - up * sz, side * sz + up * cz, ch * sx + ahead * cx)
    return [
        np.stack(pair, axis=2).reshape(len(given), 8) for pair in zip(upper, lower, strict=True)
    ]


def _travel(given: Rows) -> NDArray[np.float64]:
    """The way of the root since TRAVEL_POSES poses before, or since the first, in the body's frame,
    (n, 3) leg lengths."""
    root, yaw = given[:, _ROOT], np.radians(given[:, _YAW])
    way = root - root[np.maximum(np.arange(len(given)) - TRAVEL_POSES, 0)]
    s, c = np.sin(yaw), np.cos(yaw)
    return np.stack(
        [c * way[:, 0] - s * way[:, 2], way[:, 1], s * way[:, 0] + c * way[:, 2]], axis=1
    )
