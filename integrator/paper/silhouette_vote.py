"""Votes of both silhouettes between several poses, where one view alone is ambiguous."""

import math
from collections.abc import Callable, Iterable
from functools import partial
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, REST_DEG, Vector
from common.body.kinematics import ALL_LIMBS, ARM_LIMBS, LEG_LIMBS
from common.method import Method
from integrator.fit.silhouette_pair import Silhouettes, products

Doubt = Callable[[Vector, Vector], NDArray[np.float64]]
"""From the present pose and that of the frame before: the present one and its alternatives, (n,
25)."""


class Vote(NamedTuple):
    """An ambiguity, and the ratio of S1 S2 by which an alternative must exceed the present pose."""

    doubt: Doubt
    surely: float


SURELY: Final = 1.01
"""Ratio of S1 S2 by which a pose must exceed the one before it to be preferred."""
SQUATS: Final = 1.04
"""The same for a squat with a bowed trunk, which changes more at once."""
BENDS_DEG: Final = range(0, 71, 10)
BOWS_DEG: Final = range(0, 41, 10)
"""theta_X of the hips in a squat, and of the trunk."""
STEPS_M: Final = (-0.03, -0.012, 0.012, 0.03)
"""Displacements of the body from the place of its columns and rows, metres: a pixel is 22 mm."""

TURNS: Final = (
    (("r_hip_x", 10.0), ("r_knee_x", 16.0)),
    (("l_hip_x", 10.0), ("l_knee_x", 16.0)),
    (("r_shoulder_z", 10.0), ("r_shoulder_x", 12.0)),
    (("l_shoulder_z", 10.0), ("l_shoulder_x", 12.0)),
    (("r_hip_z", 5.0), ("l_hip_z", 5.0)),
    (("torso_x", 6.0), ("z", 0.02)),
    (("x", 0.02), ("y", 0.02)),
)
"""Parameters that are turned or moved together, and their step (degrees, metres)."""
TURN_STEPS: Final = (-2, -1, 0, 1, 2)
TURN_SHARES: Final = (1.0, 0.5)
"""Factors on the steps, in the first and the second round."""

HIPS: Final = [POSE_INDEX["r_hip_x"], POSE_INDEX["l_hip_x"]]
KNEES: Final = [POSE_INDEX["r_knee_x"], POSE_INDEX["l_knee_x"]]
SWINGS: Final = [POSE_INDEX["r_shoulder_x"], POSE_INDEX["l_shoulder_x"]]
_ARM_NAMES: Final = ("shoulder_x", "shoulder_y", "shoulder_z", "elbow_x")
ARMS: Final = [[POSE_INDEX[f"{side}_{name}"] for name in _ARM_NAMES] for side in "rl"]
HANGING: Final = [[REST_DEG.get(f"{side}_{name}", 0.0) for name in _ARM_NAMES] for side in "rl"]


_LIMBS_OF: Final = np.array(
    [ALL_LIMBS] * 6
    + [1 << 1] * 3
    + [sum(1 << limb for limb in arm) for arm in ARM_LIMBS for _ in range(3)]
    + [1 << arm[1] for arm in ARM_LIMBS]
    + [sum(1 << limb for limb in leg) for leg in LEG_LIMBS for _ in range(3)]
    + [1 << leg[1] for leg in LEG_LIMBS]
)
"""The limbs, as bits, that each parameter of a pose moves."""


def moving(poses: NDArray[np.float64]) -> int:
    """The limbs, as bits, in which some poses differ from the first."""
    return int(np.bitwise_or.reduce(_LIMBS_OF[(poses != poses[0]).any(axis=0)], initial=0))


def votes_of(method: Method, upright_m: float, leg_m: float, fitted: bool) -> list[Vote]:
    """The votes of both silhouettes, in order, each between a few poses.

    They concern: whether the person squats; where the body is; which arm swings, or whether both do
    (L3); whether an arm was lost, and is where it was or hangs. A body that was fitted to its
    silhouette is then turned joint by joint too. One that was measured in the opening posture is
    not: its cylinders have no feet, and would bend to cover them.

    Args:
        method: Selects the votes.
        upright_m: Height of the navel of the person standing upright.
        leg_m: Length of a leg.
        fitted: The body is a prior that was fitted to the silhouette.
    """
    votes: list[Vote] = []
    if method.squat_votes:
        votes.append(Vote(partial(squatted, upright_m, leg_m), SQUATS))
    if method.place_votes:
        votes.append(Vote(shifted, SURELY))
    if method.arm_votes:
        votes += [
            Vote(each, SURELY) for each in (swung, partial(regained, 0), partial(regained, 1))
        ]
    if method.turn_votes and fitted:
        votes += [
            Vote(partial(turned, pair, share), 1.0) for share in TURN_SHARES for pair in TURNS
        ]
    return votes


def settled(
    pose: Vector, before: Vector, body: Vector, silhouettes: Silhouettes, votes: Iterable[Vote]
) -> Vector:
    """The fused pose, with its ambiguities resolved by both silhouettes.

    Each vote takes the pose with the highest S1 S2; the first one, which is the present pose, stays
    unless another is clearly better.

    Args:
        pose: The fusion of the two views' angles, (25,).
        before: Pose of the frame before.
        body: Body vector.
        silhouettes: Both views' silhouettes, in pictures of one size.
        votes: In their order.
    """
    for doubt, surely in votes:
        poses = doubt(pose, before)
        likely = products(body, poses, moving(poses), *silhouettes)
        best = int(likely.argmax())
        pose = poses[best if likely[best] > surely * likely[0] else 0]
    return pose


def squatted(upright_m: float, leg_m: float, pose: Vector, _before: Vector) -> NDArray[np.float64]:
    """The pose, and the same in squats of all depths, the trunk bowed or not, (n, 25).

    The feet stay on the floor, under the hips (P34), so the navel sinks as the knees bend. Shifting
    a model with straight legs cannot find that: its legs stand on the floor as well.
    """
    squats = list(product(BENDS_DEG, BOWS_DEG))
    poses = np.tile(pose, (1 + len(squats), 1))
    for row, (bend, bow) in zip(poses[1:], squats, strict=True):
        row[POSE_INDEX["y"]] = upright_m - leg_m * (1.0 - math.cos(math.radians(bend)))
        row[POSE_INDEX["torso_x"]] = bow
        row[HIPS] = bend + bow
        row[KNEES] = -2 * bend
    return poses


def shifted(pose: Vector, _before: Vector) -> NDArray[np.float64]:
    """The pose, and the same displaced to every side, (n, 25)."""
    moved = [(axis, step) for axis in range(3) for step in STEPS_M]
    poses = np.tile(pose, (1 + len(moved), 1))
    for row, (axis, step) in enumerate(moved, 1):
        poses[row, axis] += step
    return poses


def swung(pose: Vector, before: Vector) -> NDArray[np.float64]:
    """The pose, and each assignment of the found swings to the arms, (n, 25).

    The flank view shows both arms as one silhouette; the facade shows which of them left the
    trunk's side.
    """
    right, left = pose[SWINGS]
    old_right, old_left = before[SWINGS]
    pairs = [
        (right, left),
        (right, old_left),
        (old_right, left),
        (old_right, old_left),
        (left, right),
        (right, right),
        (left, left),
        (right, 0.0),
        (0.0, left),
        (0.0, 0.0),
    ]
    poses = np.tile(pose, (len(pairs), 1))
    poses[:, SWINGS] = pairs
    return poses


def regained(i: int, pose: Vector, before: Vector) -> NDArray[np.float64]:
    """The pose, and the same with arm i (0 right, 1 left) as it was and hanging, (3, 25)."""
    poses = np.tile(pose, (3, 1))
    poses[1, ARMS[i]] = before[ARMS[i]]
    poses[2, ARMS[i]] = HANGING[i]
    return poses


def turned(
    pair: tuple[tuple[str, float], tuple[str, float]],
    share: float,
    pose: Vector,
    _before: Vector,
) -> NDArray[np.float64]:
    """The pose, and the same with two of its parameters up to two steps either way, (25, 25)."""
    steps = [(0, 0), *(each for each in product(TURN_STEPS, TURN_STEPS) if each != (0, 0))]
    poses = np.tile(pose, (len(steps), 1))
    for (name, size), turns in zip(pair, np.array(steps).T, strict=True):
        poses[:, POSE_INDEX[name]] += share * size * turns
    poses[:, KNEES] = np.minimum(poses[:, KNEES], 0.0)
    return poses
