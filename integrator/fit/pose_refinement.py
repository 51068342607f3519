"""A pose matched to both silhouettes, where the proposed one matches badly."""

import math
from itertools import product
from operator import itemgetter
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, POSE_NAMES, Vector, rest_pose
from common.body.kinematics import ALL_LIMBS, joints
from common.compiled import compiled
from common.raster.kernel import match
from common.rig.camera import Rig
from integrator.fit.silhouette_pair import Silhouettes, products, silhouettes_of
from integrator.pairing import Seen
from integrator.pose.inverse_kinematics import HIGH_DEG, LOW_DEG

POOR: Final = 0.6
"""A proposal of less S in either view is matched: of r01's and r04's every twentieth is."""
BETTER: Final = 1.25
"""How many times better S1 S2 must be for a matched pose to go on."""
DOUBT: Final = 6.0
"""How fast a proposal that fits worse is believed less, however confident it is."""
SILHOUETTE_WEIGHT: Final = 150.0
"""What the log of S1 S2 counts beside the log likelihood of what was proposed."""

ROUNDS: Final = 20
SAMPLES: Final = 50
BEST: Final = 10
"""How many poses are tried in each round, and how many of them tell where the next are tried."""
KEPT: Final = 0.3
"""Share of a round's spread that the next keeps; the rest is the spread of the best poses ..."""
WIDENED: Final = 1.1
"""... widened, since a few best poses lie closer together than what may yet be better."""

_SPREADS: Final = {
    **dict.fromkeys(("x", "y", "z"), 0.025),
    **dict.fromkeys(("torso_x", "torso_y", "torso_z"), 6.0),
    **dict.fromkeys(("neck_x", "neck_y", "neck_z"), 4.0),
    **{f"{side}_shoulder_{axis}": 15.0 if axis == "y" else 10.0 for side in "rl" for axis in "xyz"},
    **dict.fromkeys(("r_elbow_x", "l_elbow_x"), 12.5),
    **{f"{side}_hip_{axis}": 7.5 for side in "rl" for axis in "xyz"},
    **dict.fromkeys(("r_knee_x", "l_knee_x"), 10.0),
}
SPREAD: Final = np.array([_SPREADS[name] for name in POSE_NAMES])
"""Standard deviation of the first round, metres and degrees: what a body does in 1/15 s."""
AT_FIRST: Final = 2.0
"""How many times wider poses are tried where none was known before."""
SEARCHED_AGAIN: Final = 3
"""Of those, how many are followed up: which way somebody faces is told by little."""
YAWS_DEG: Final = range(0, 360, 45)

_RADII: Final = np.linspace(0.2, 4.0, 60)
_WITHIN: Final = (
    _RADII,
    np.array(
        [
            math.erf(r / math.sqrt(2.0)) - math.sqrt(2.0 / math.pi) * r * math.exp(-r * r / 2.0)
            for r in _RADII
        ]
    ),
)
"""Radii in standard deviations, and how probably a point of a round normal cloud is within."""
_DRAWS: Final = np.random.default_rng(1).standard_normal((ROUNDS, SAMPLES, len(POSE_NAMES)))
"""The same at every instant, so that a run can be repeated."""


class Wanted(NamedTuple):
    """What a pose is held against."""

    body: Vector
    """Body vector."""
    silhouettes: Silhouettes
    joints_m: NDArray[np.float64]
    """(15, 3) the landmarks of the proposed pose."""
    tightness: Vector
    """(15,) 1 / m^2: half the inverse variance of each of them."""


class Previous(NamedTuple):
    """What was made of the frame before."""

    pose: Vector | None = None
    """None at the first."""
    matched: bool = False
    """The pose was matched, as the proposed one fitted badly."""


def refined(
    proposed: Vector,
    confidence: Vector,
    previous: Previous,
    body: Vector,
    rig: Rig,
    seen: Seen,
) -> Vector | None:
    """The pose that both silhouettes and the proposed one together speak for.

    It is looked for near the proposed one, or near the one before it; where none was known before,
    also near somebody who stands where the proposed pose is, turned to any side. A proposal that
    no pose near it makes match is refuted: then the silhouettes alone speak.

    Args:
        proposed: By the silhouettes, (25,).
        confidence: (15,) how probably each of its landmarks is less than 50 mm off.
        previous: After a pose that was matched, a proposal must match nearly as well to be
            believed again.
        body: Body vector.
        rig: Two cameras.
        seen: Both views' reports.

    Returns:
        None where the proposed pose matches well, and where one view alone shows somebody.
    """
    first, second = seen
    if first is None or second is None:
        return None
    silhouettes = silhouettes_of(rig, (first, second))
    wanted = Wanted(body, silhouettes, joints(body, proposed), 0.5 / spread_m(confidence) ** 2)
    fits = _poorest(proposed, body, silhouettes)
    if fits >= POOR:
        if not previous.matched or previous.pose is None:
            return None
        return _held(proposed, previous.pose, wanted)
    wanted = wanted._replace(tightness=wanted.tightness * (fits / POOR) ** DOUBT)
    before = previous.pose
    pose = proposed if before is None else _searched(proposed, before, wanted)
    if _poorest(pose, body, silhouettes) >= POOR:
        return pose
    refuted = wanted._replace(tightness=np.zeros(len(confidence)))
    return _searched(pose, before, refuted)


def _held(proposed: Vector, before: Vector, wanted: Wanted) -> Vector | None:
    """The pose that goes on from the one before, where the proposed one matches surely worse."""
    pose, _ = cross_entropy(before, 1.0, wanted)
    fits = products(wanted.body, np.stack([pose, proposed]), ALL_LIMBS, *wanted.silhouettes)
    return pose if fits[0] > BETTER * fits[1] else None


def _searched(proposed: Vector, before: Vector | None, wanted: Wanted) -> Vector:
    if before is None:
        starts = [proposed, *_standing_poses(proposed)]
        found = [cross_entropy(start, AT_FIRST, wanted) for start in starts]
        likely = sorted(found, key=itemgetter(1), reverse=True)[:SEARCHED_AGAIN]
        return max((cross_entropy(pose, 1.0, wanted) for pose, _ in likely), key=itemgetter(1))[0]
    near = np.stack([before, proposed])
    return cross_entropy(near[likelihoods(near, wanted).argmax()], 1.0, wanted)[0]


def cross_entropy(start: Vector, wider: float, wanted: Wanted) -> tuple[Vector, float]:
    """The likeliest pose that rounds of samples met, and its log likelihood.

    Each round draws poses around the mean of the round before's best, as far apart as those were
    (the cross-entropy method of Rubinstein 1999, a deviation for each parameter).

    Args:
        start: Where the first round looks, (25,).
        wider: Times SPREAD that it looks around.
        wanted: What poses are held against.
    """
    middle, spread = start, wider * SPREAD
    best, likely = start, float(likelihoods(start[None], wanted)[0])
    for draws in _DRAWS:
        poses: NDArray[np.float64] = np.clip(middle + draws * spread, LOW_DEG, HIGH_DEG)
        poses[0] = best
        found = likelihoods(poses, wanted)
        order = np.argsort(-found, kind="stable")[:BEST]
        if found[order[0]] > likely:
            best, likely = poses[order[0]], float(found[order[0]])
        middle = poses[order].mean(axis=0)
        spread = KEPT * spread + (1 - KEPT) * WIDENED * poses[order].std(axis=0)
    return best, likely


def likelihoods(poses: NDArray[np.float64], wanted: Wanted) -> Vector:
    """Log likelihood of each pose, (n,): what both silhouettes say, and what was proposed."""
    fits = products(wanted.body, poses, ALL_LIMBS, *wanted.silhouettes)
    penalties = _penalties(wanted.body, poses, wanted.joints_m, wanted.tightness)
    found: Vector = SILHOUETTE_WEIGHT * np.log(np.maximum(fits, 1e-9)) - penalties
    return found


@compiled
def _penalties(body: Any, poses: Any, joints_m: Any, tightness: Any) -> Any:
    """How improbably far the landmarks of each pose are from others, (n,)."""
    found = np.zeros(len(poses))
    for i in range(len(poses)):
        off = joints(body, poses[i]) - joints_m
        for j in range(len(tightness)):
            square = off[j, 0] ** 2 + off[j, 1] ** 2 + off[j, 2] ** 2
            found[i] += math.log1p(tightness[j] * square)
    return found


def spread_m(confidence: Vector) -> Vector:
    """Standard deviation of a joint that is so probably less than 50 mm off, each axis."""
    found: Vector = 0.05 / np.interp(confidence, _WITHIN[1], _WITHIN[0])
    return found


def poorest(pose: Vector, body: Vector, rig: Rig, seen: Seen) -> float:
    """S of a pose in that of both views where it is lower; 1 where one of them shows nobody."""
    first, second = seen
    if first is None or second is None:
        return 1.0
    return _poorest(pose, body, silhouettes_of(rig, (first, second)))


def _poorest(pose: Vector, body: Vector, silhouettes: Silhouettes) -> float:
    views, masks, areas, width = silhouettes
    return min(
        float(match(body, pose, view, ALL_LIMBS, width, mask, int(area)))
        for view, mask, area in zip(views, masks, areas, strict=True)
    )


def _standing_poses(proposed: Vector) -> list[Vector]:
    """Somebody who stands at the place of a pose, arms hanging or stretched, to every side."""
    poses = []
    for yaw_deg, raised_deg in product(YAWS_DEG, (0.0, 90.0)):
        pose = rest_pose()
        pose[:3] = proposed[:3]
        pose[POSE_INDEX["torso_y"]] = yaw_deg
        pose[POSE_INDEX["r_shoulder_z"]] -= raised_deg
        pose[POSE_INDEX["l_shoulder_z"]] += raised_deg
        poses.append(pose)
    return poses
