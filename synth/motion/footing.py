"""Feet on the floor: the pelvis's place for which the standing foot rests."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.person.skeleton import (
    ANGLES,
    BALL_SHARE,
    BONE_INDEX,
    HEEL_SHARE,
    bone_frames,
    joint_places,
    shoe_length,
)

SMOOTH_M: Final = 0.006
"""Height difference below which both ankles share the weight in proportion."""


LEASH: Final = 0.1
"""Share of the way to the leash's end that the pelvis moves per frame."""


class Posed(NamedTuple):
    """A body over time."""

    joints_m: NDArray[np.float64]
    """(n, 20, 3), world."""
    bones: NDArray[np.float64]
    """(n, bones, 3, 4): rotation to the world, and the origin."""


def posed(
    measures: dict[str, float], angles_deg: Vector, start_m: Vector, leash: Vector | None = None
) -> Posed:
    """Joints and bones of a movement, the lowest sole on the floor and the standing foot at rest.

    Args:
        measures: Of the body.
        angles_deg: (n, 27), in the order of ANGLES.
        start_m: (2,) x and z of the pelvis in the first frame.
        leash: (n, 2) place that attracts the pelvis; feet then slide. NaN: none.
    """
    angle = {name: angles_deg[:, i] for i, name in enumerate(ANGLES)}
    bones = bone_frames(measures, angle)
    soles = np.stack([_sole(measures, bones, side) for side in "lr"], axis=1)  # (n, 2, 3, 3)
    ankles = np.stack([bones[:, BONE_INDEX[f"{side}_foot"], 1, 3] for side in "lr"], axis=1)
    root = _planted(soles, ankles, start_m, leash)
    bones[..., 3] += root[:, None]
    lowest = np.minimum(soles[..., 1].min(axis=(1, 2)), _lowest_hand(measures, bones))
    bones[:, :, 1, 3] -= lowest[:, None]
    return Posed(joint_places(measures, bones), bones)


def _sole(measures: dict[str, float], bones: NDArray[np.float64], side: str) -> Vector:
    """Heel, ball and tip of a sole, (n, 3, 3)."""
    length = shoe_length(measures)
    along = np.array([-HEEL_SHARE, BALL_SHARE - HEEL_SHARE, 1.0 - HEEL_SHARE]) * length
    local = np.stack([np.zeros(3), np.full(3, -measures["ankle_height_m"]), along], axis=1)
    foot = bones[:, BONE_INDEX[f"{side}_foot"]]
    places: Vector = np.einsum("nij,kj->nki", foot[..., :3], local) + foot[:, None, :, 3]
    return places


def _lowest_hand(measures: dict[str, float], bones: NDArray[np.float64]) -> Vector:
    """Height of the lower fingertip, so that no hand passes through the floor, (n,)."""
    tips = [
        bones[:, BONE_INDEX[f"{side}_hand"], 1, 3]
        - measures["hand_m"] * bones[:, BONE_INDEX[f"{side}_hand"], 1, 1]
        for side in "lr"
    ]
    lowest: Vector = np.minimum(*tips)
    return lowest


def _planted(
    soles: NDArray[np.float64], heights: Vector, start_m: Vector, leash: Vector | None
) -> Vector:
    """Places of the pelvis, (n, 3) with y = 0: the foot with the lower ankle stands still."""
    weight = 1.0 / (1.0 + np.exp(np.clip((heights[:, 0] - heights[:, 1]) / SMOOTH_M, -60, 60)))
    carried = np.stack([weight, 1.0 - weight], axis=1)
    feet = soles[..., [0, 2]].mean(axis=2)  # (n, 2, 2)
    share = (carried[1:] + carried[:-1])[..., None] / 2
    steps = -(share * np.diff(feet, axis=0)).sum(axis=1)
    root = np.zeros((len(soles), 3))
    root[0, [0, 2]] = start_m
    for i, step in enumerate(steps):
        root[i + 1, [0, 2]] = root[i, [0, 2]] + step
        if leash is not None and np.isfinite(leash[i + 1]).all():
            root[i + 1, [0, 2]] += LEASH * (leash[i + 1] - root[i + 1, [0, 2]])
    return root
