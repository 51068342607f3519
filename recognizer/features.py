"""The feature vectors: the paper's ten angles as directions, and all limbs' with the travel."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLE_INDEX, ANGLE_NAMES, JOINT_NAMES
from common.compiled import compiled

Rows = NDArray[np.float64]
"""A tracked stretch of frames: (n, 20), ROW_NAMES order, NaN where there is no pose."""

ROW_NAMES: Final = (*ANGLE_NAMES, "root_x", "root_y", "root_z")
"""The 17 angles (degrees) and the pelvis's place in the world (leg lengths of that body)."""

LEG: Final = tuple(JOINT_NAMES.index(f"r_{joint}") for joint in ("hip", "knee", "ankle"))
PELVIS: Final = JOINT_NAMES.index("pelvis")

Features = NDArray[np.float64]
"""Feature vectors: (n, 16), each entry in [-1, 1]."""

ANGLES: Final = (
    "r_shoulder_x",
    "r_shoulder_z",
    "l_shoulder_x",
    "l_shoulder_z",
    "r_elbow_x",
    "l_elbow_x",
    "r_hip_x",
    "r_hip_z",
    "l_hip_x",
    "l_hip_z",
)
"""The ten angles that describe a posture (section 5.1, P57)."""

LIMBS: Final = ("r_shoulder", "l_shoulder", "r_hip", "l_hip")
ELBOWS: Final = ("r_elbow", "l_elbow")

FEATURE_NAMES: Final = tuple(
    [f"{limb}_{axis}" for limb in LIMBS for axis in ("right", "up", "forward")]
    + [f"{elbow}_{part}" for elbow in ELBOWS for part in ("cos", "sin")]
)
"""The order of a feature vector; a model records the order that it was trained with."""


def rows(angles_deg: NDArray[np.float64], joints_m: NDArray[np.float64]) -> Rows:
    """The recogniser's input for a stretch of frames, (n, 20).

    Places are in leg lengths, so that a tall and a small person who squat alike look alike, and a
    world of assumed scale resembles a measured one.

    Args:
        angles_deg: (n, 17), ANGLE_NAMES order; NaN where there is no pose.
        joints_m: (n, 15, 3), JOINT_NAMES order; NaN where there is no pose.
    """
    hip, knee, ankle = (joints_m[:, joint] for joint in LEG)
    leg_m = np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)
    return np.concatenate([angles_deg, joints_m[:, PELVIS] / leg_m[:, np.newaxis]], axis=1)


def with_pose(given: Rows) -> Rows:
    """The complete rows (m, 20): frames without a pose are dropped.

    A missing observation is no symbol: a hidden Markov model takes the next one, and repeating the
    old pose would show it a standstill that was not seen.
    """
    return given[np.isfinite(given).all(axis=1)]


def features(given: Rows) -> Features:
    """The ten angles of each frame as a point of a space without seams, shape (n, 16).

    The observation is the paper's; the space, which defines neighbouring symbols, is ours. Plain
    numbers would not do. theta_X = 179 and -179 lie far apart. With theta_X = 90 (arm forward)
    every theta_Z is the same pose. (theta_X, theta_Z) and (180 - theta_X, theta_Z + 180) are one
    direction. So upper arms and thighs enter as the direction of their two angles in the body's own
    frame, Rz(theta_Z) Rx(theta_X) (0, 1, 0), and elbows as cosine and sine.

    Source: Huang & Chung 2004, section 5.1 (P57); section 2.2, M_N^S (C3, C4).
    """
    radians = {name: np.radians(given[:, ANGLE_INDEX[name]]) for name in ANGLES}
    columns = []
    for limb in LIMBS:
        x, z = radians[f"{limb}_x"], radians[f"{limb}_z"]
        columns += [np.sin(z) * np.cos(x), np.cos(z) * np.cos(x), np.sin(x)]
    for elbow in ELBOWS:
        columns += [np.cos(radians[f"{elbow}_x"]), np.sin(radians[f"{elbow}_x"])]
    return np.stack(columns, axis=1)


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
"""The order of a vector; a model records the order that it was trained with."""

TRAVEL_POSES: Final = 5
"""Number of poses over which travel is measured: a third of a second, half a step."""
TRAVEL_WEIGHT: Final = 2.0
"""Weight of travel, which varies less than directions: one lower bound of variance then fits
both."""

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

    A direction is a limb's own axis in the body's frame; travel is in the body's frame too: to its
    side, up, and ahead. Without travel no model could distinguish walking towards a person from
    walking in place: the paper's ten angles describe limbs alone.

    Source: section 2.2 (M_N^S, M_S^F: C3, C4) for the directions.
    """
    shown = np.empty((len(given), len(BEARING_NAMES)))
    for chain, turns in enumerate(_TURNS):
        _point(given[:, turns], shown[:, 6 * chain : 6 * chain + 6])
    _move(given[:, _ROOT:], given[:, _YAW], shown[:, -3:])
    return shown


@compiled
def _point(turns_deg: NDArray[np.float64], shown: NDArray[np.float64]) -> None:
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
def _move(
    root: NDArray[np.float64], yaw_deg: NDArray[np.float64], shown: NDArray[np.float64]
) -> None:
    """Write the weighted displacement of the root over TRAVEL_POSES poses, or since the first,
    in the body's frame."""
    for row in range(len(root)):
        way = TRAVEL_WEIGHT * (root[row] - root[max(row - TRAVEL_POSES, 0)])
        s, c = math.sin(math.radians(yaw_deg[row])), math.cos(math.radians(yaw_deg[row]))
        shown[row, 0] = c * way[0] - s * way[2]
        shown[row, 1] = way[1]
        shown[row, 2] = s * way[0] + c * way[2]
