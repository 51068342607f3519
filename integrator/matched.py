"""A pose matched to both silhouettes, where the proposed one matches badly."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body import LIMITS_DEG, POSE_INDEX, POSE_NAMES, Vector, rest_pose
from common.camera import Rig
from common.kernel import match
from common.kinematics import ALL_LIMBS
from integrator.hypotheses import products
from integrator.pairing import Seen
from integrator.two_outlines import Outlines, outlines_of

POOR: Final = 0.6
"""A proposal of less S in either view is matched: of r01's and r04's every twentieth is."""
BETTER: Final = 1.1
"""How many times better S1 S2 must be for a matched pose to be taken for the proposed one."""

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
YAWS_DEG: Final = range(0, 360, 45)

_LOW: Final = np.array([LIMITS_DEG.get(name, (-np.inf, np.inf))[0] for name in POSE_NAMES])
_HIGH: Final = np.array([LIMITS_DEG.get(name, (-np.inf, np.inf))[1] for name in POSE_NAMES])
_DRAWS: Final = np.random.default_rng(1).standard_normal((ROUNDS, SAMPLES, len(POSE_NAMES)))
"""The same at every instant, so that a run can be repeated."""


def instead(
    proposed: Vector, before: Vector | None, body: Vector, rig: Rig, seen: Seen
) -> Vector | None:
    """The pose with the highest S1 S2 near the proposed one, or near the one before it.

    Where no pose was known before, also near somebody who stands where the proposed pose is,
    turned to any side.

    Args:
        proposed: By the silhouettes, (25,).
        before: Of the frame before; None at the first.
        body: Body vector.
        rig: Two cameras.
        seen: Both views' reports.

    Returns:
        None where the proposed pose matches well, where no other matches surely better, and where
        one view alone shows somebody.
    """
    first, second = seen
    if first is None or second is None:
        return None
    outlines = outlines_of(rig, (first, second))
    scores = [_in_view(n, proposed, body, outlines) for n in range(2)]
    if min(scores) >= POOR:
        return None
    pose, likely = _searched(proposed, before, body, outlines)
    return pose if likely > BETTER * scores[0] * scores[1] else None


def _in_view(n: int, pose: Vector, body: Vector, seen: Outlines) -> float:
    masks, own = seen.seen[n], int(seen.seen_px[n])
    return float(match(body, pose, seen.views[n], ALL_LIMBS, seen.width, masks, own))


def _searched(
    proposed: Vector, before: Vector | None, body: Vector, seen: Outlines
) -> tuple[Vector, float]:
    if before is None:
        starts = [proposed, *_standing(proposed)]
        found = [climbed(start, AT_FIRST, body, seen) for start in starts]
        return max(found, key=lambda each: each[1])
    near = np.stack([before, proposed])
    return climbed(near[products(body, near, ALL_LIMBS, *seen).argmax()], 1.0, body, seen)


def climbed(start: Vector, wider: float, body: Vector, seen: Outlines) -> tuple[Vector, float]:
    """The best pose that rounds of samples met, and its S1 S2.

    Each round draws poses around the mean of the round before's best, as far apart as those were
    (the cross-entropy method of Rubinstein 1999, a deviation for each parameter).

    Args:
        start: Where the first round looks, (25,).
        wider: Times SPREAD that it looks around.
        body: Body vector.
        seen: Both views' silhouettes.
    """
    middle, spread = start, wider * SPREAD
    best, likely = start, float(products(body, start[None], ALL_LIMBS, *seen)[0])
    for draws in _DRAWS:
        poses: NDArray[np.float64] = np.clip(middle + draws * spread, _LOW, _HIGH)
        poses[0] = best
        found = products(body, poses, ALL_LIMBS, *seen)
        order = np.argsort(-found, kind="stable")[:BEST]
        if found[order[0]] > likely:
            best, likely = poses[order[0]], float(found[order[0]])
        middle = poses[order].mean(axis=0)
        spread = KEPT * spread + (1 - KEPT) * WIDENED * poses[order].std(axis=0)
    return best, likely


def _standing(proposed: Vector) -> list[Vector]:
    """Somebody at the place of a pose who stands with hanging arms, turned to every side."""
    poses = []
    for yaw_deg in YAWS_DEG:
        pose = rest_pose()
        pose[:3] = proposed[:3]
        pose[POSE_INDEX["torso_y"]] = yaw_deg
        poses.append(pose)
    return poses
