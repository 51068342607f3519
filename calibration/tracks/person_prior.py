"""Prior on any person: segment lengths as shares of the stature, and how a person stands."""

from typing import Final

import numpy as np

from common.body.body import JOINT_NAMES
from common.body.proportions import BONE_SHARES

AT: Final = {name: n for n, name in enumerate(JOINT_NAMES)}
PELVIS, NECK = AT["pelvis"], AT["neck"]
ANKLES: Final = [AT["l_ankle"], AT["r_ankle"]]
SHOULDERS: Final = [AT["l_shoulder"], AT["r_shoulder"]]
LENGTHS: Final = tuple(BONE_SHARES)
"""Names of the body's lengths, in order."""
SHARES: Final = np.array(list(BONE_SHARES.values()))
SPREADS: Final = np.array([0.03, 0.05, 0.04, 0.06, 0.04, 0.04, 0.12, 0.2])
"""Standard deviation of each length's logarithm among people."""

TRUNK, ARMS, LEGS = 0, 1, 2
"""Parts whose sides a view may exchange independently; the trunk has none."""
_SEGMENTS: Final = (
    ("pelvis", "neck", 0, TRUNK),
    ("neck", "head_top", 1, TRUNK),
    *((f"{s}_shoulder", f"{s}_elbow", 2, ARMS) for s in "lr"),
    *((f"{s}_elbow", f"{s}_wrist", 3, ARMS) for s in "lr"),
    *((f"{s}_hip", f"{s}_knee", 4, LEGS) for s in "lr"),
    *((f"{s}_knee", f"{s}_ankle", 5, LEGS) for s in "lr"),
    ("l_shoulder", "r_shoulder", 6, ARMS),
    ("l_hip", "r_hip", 7, LEGS),
)
ENDS: Final = np.array([[AT[a], AT[b]] for a, b, _, _ in _SEGMENTS])
"""(12, 2) the joints at both ends of each segment."""
LENGTH_OF: Final = np.array([length for _, _, length, _ in _SEGMENTS])
"""(12,) index in LENGTHS of each segment."""
PART_OF_SEGMENT: Final = np.array([part for _, _, _, part in _SEGMENTS])
PART_OF_JOINT: Final = np.array(
    [
        ARMS
        if name.endswith(("shoulder", "elbow", "wrist"))
        else LEGS
        if name.endswith(("hip", "knee", "ankle"))
        else TRUNK
        for name in JOINT_NAMES
    ]
)

UPRIGHT: Final = np.array([1, 1, 0, 0, 1, 1, 0, 0], bool)
"""The lengths whose sum is the height of the crown above the ankles."""
CROWN_SHARE: Final = 0.952
"""That sum, statures."""
ANKLE_SHARE: Final = 0.050
"""Height of a standing foot's ankle above the floor, statures."""
