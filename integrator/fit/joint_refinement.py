"""A body of one view turned joint by joint until its picture fits the silhouette best (3.1.4)."""

import math
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, POSE_INDEX, Bdp, Vector
from common.body.kinematics import joints
from common.body.proportions import body_vector, stature
from common.body.stick_body import BREADTH, GIRTH, HALF_SHOULDERS, POSE_SIZE, STATURE, Stickman
from common.bus.messages import Report
from common.compiled import compiled
from common.raster.bits import Bits, count, count_both
from common.raster.kernel import NEAREST_M, score, seen_at, view_of
from common.raster.stick_raster import ALL_SEGMENTS, draw_segments
from common.rig.camera import Camera, arrays_of
from integrator.fit.silhouette_pair import packed
from integrator.pose.inverse_kinematics import HIGH_DEG, LOW_DEG

PELVIS: Final = JOINT_NAMES.index("pelvis")
GIRTHS: Final = (1.0, 1.15, 1.3, 1.5)
"""How thick clothed limbs may be over those of the proportions."""
GOOD: Final = 0.7
"""A body whose S is higher is left as it is: its joints are better known than its silhouette."""
LEAST_GAIN: Final = 0.001
"""A turn that gains less in S is not made: it may be noise of the silhouette."""
SHARES: Final = (1.0, 0.5, 1.0, 0.5, 0.25)
"""Of the steps, round by round."""

_COORDINATES: Final = (
    *((name, 0.06) for name in "xy"),
    *((name, 8.0) for name in ("torso_z", "torso_x")),
    *((f"{side}_{name}", 16.0) for side in "rl" for name in ("hip_x", "hip_z", "knee_x")),
    *((f"{side}_{name}", 16.0) for side in "rl" for name in ("shoulder_x", "shoulder_z")),
    *((f"{side}_elbow_x", 16.0) for side in "rl"),
)
"""What is moved or turned, in this order, by how much at first: metres or degrees."""
_AT: Final = np.array([POSE_INDEX[name] for name, _ in _COORDINATES])
_STEPS: Final = np.array([step for _, step in _COORDINATES])
_ENDS: Final = np.concatenate(
    [LIMB_ENDS]
    + [[[JOINT_NAMES.index(f"{side}_{name}") for side in "rl"]] for name in ("shoulder", "hip")]
)
"""(12, 2): joints at the ends of LIMBS, of the line of the shoulders and of that of the hips."""


class Task(NamedTuple):
    """What is matched with what; its members are also what the compiled functions read."""

    body: Vector
    """Body vector."""
    view_vector: Vector
    """(VIEW,)"""
    parts: Vector
    depth: float
    """The Stickman's."""
    broad_px: float
    """The line of the shoulders of somebody who faces the camera."""
    seen: Bits
    seen_px: int
    width: int
    """The silhouette, its pixels, and the width of the picture."""


class PosedBody(NamedTuple):
    """A pose, and the joints that belong to it."""

    pose: Vector
    """Within the limits."""
    joints_m: NDArray[np.float64]
    """(15, 3) world; they need not be where the pose's cylinders have them."""


class Match(NamedTuple):
    """A body, and how well its picture fits."""

    pose: Vector
    joints_m: NDArray[np.float64]
    score: float


def matched(
    camera: Camera,
    bdp: Bdp,
    man: Stickman,
    report: Report,
    start: PosedBody,
    refining: bool,
) -> Match:
    """S of a body drawn as the stick body is, as thick as fits best; turned where that is low.

    Args:
        camera: Calibrated at the size of the report's picture, without distortion.
        bdp: The body.
        man: How thick its parts are.
        report: Of that camera.
        start: As it is so far; it stays within the limits.
        turning: Whether the pose may be turned.
    """
    pose, joints_m = start
    tall_px = _tall_px(camera, stature(bdp), joints_m)
    body = body_vector(bdp)
    task = _task(camera, body, man, report, tall_px)
    stick = np.ones(POSE_SIZE)
    stick[STATURE] = tall_px
    best, girth = 0.0, GIRTHS[0]
    for thickness in GIRTHS:
        stick[GIRTH] = thickness
        value = float(_similarity(task, stick, joints_m))
        if value > best:
            best, girth = value, thickness
    if best >= GOOD or not refining:
        return Match(pose, joints_m, best)
    stick[GIRTH] = girth
    refined, best = _coordinate_descent(task, stick, pose, joints_m)
    return Match(refined, joints_m + joints(body, refined) - joints(body, pose), float(best))


def _tall_px(camera: Camera, stature_m: float, joints_m: NDArray[np.float64]) -> float:
    """How tall the body would stand in the picture where its pelvis is."""
    deep_m = float(arrays_of(camera).R[2] @ joints_m[PELVIS] + camera.t[2])
    return camera.K[1][1] * stature_m / max(deep_m, NEAREST_M)


def _task(camera: Camera, body: Vector, man: Stickman, report: Report, tall_px: float) -> Task:
    seen, view = packed(report), view_of(camera)
    broad_px = 2 * man.lengths[HALF_SHOULDERS] * tall_px
    return Task(body, view, man.parts, man.depth, broad_px, seen, count(seen), report.width)


@compiled
def _coordinate_descent(task: Any, stick: Any, pose: Any, joints_m: Any) -> tuple[Any, float]:
    """(pose, S): each parameter in turn, up and down, by smaller and smaller steps."""
    best_pose, trial = pose.copy(), pose.copy()
    rest = joints_m - joints(task.body, pose)
    best = _similarity(task, stick, joints_m)
    for share in SHARES:
        for k in range(_AT.size):
            at = _AT[k]
            for step in (-share * _STEPS[k], share * _STEPS[k]):
                trial[:] = best_pose
                trial[at] = min(max(best_pose[at] + step, LOW_DEG[at]), HIGH_DEG[at])
                value = _similarity(task, stick, rest + joints(task.body, trial))
                if value > best + LEAST_GAIN:
                    best = value
                    best_pose[:] = trial
    return best_pose, best


@compiled
def _similarity(task: Any, stick: Any, joints_m: Any) -> float:
    """S of the body with these joints; `stick` gets the breadth that it shows."""
    ends = np.empty((12, 4))
    for row in range(12):
        for end in range(2):
            joint = _ENDS[row, end]
            x, y, z = joints_m[joint]
            ends[row, 2 * end], ends[row, 2 * end + 1], _ = seen_at(task.view_vector, x, y, z)
    across_px = math.hypot(ends[10, 2] - ends[10, 0], ends[10, 3] - ends[10, 1])
    stick[BREADTH] = min(1.0, across_px / task.broad_px)
    bits = np.zeros_like(task.seen)
    draw_segments(ends, stick, task.parts, task.depth, ALL_SEGMENTS, task.width, bits)
    return score(count_both(bits, task.seen), count(bits), task.seen_px)
