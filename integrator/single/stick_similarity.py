"""S of a body whose joints are drawn as a stick body, with the best-fitting thickness of clothes
(P9)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, Floats, Vector
from common.body.stick_body import BREADTH, GIRTH, HALF_SHOULDERS, POSE_SIZE, SHOULDER_LINE, STATURE
from common.compiled import compiled
from common.raster.bits import Bits, count, count_both
from common.raster.kernel import NEAREST_M, score, seen_at, view_of
from common.raster.silhouette_report import words_of
from common.raster.stick_raster import ALL_SEGMENTS, draw_segments
from common.rig.camera import Camera, arrays_of
from integrator.rig.undistortion import undistorted_camera
from integrator.single.sight import Sight

PELVIS: Final = JOINT_NAMES.index("pelvis")
GIRTHS: Final = (1.0, 1.15, 1.3, 1.5)
"""Thickness of clothed limbs over that of the proportions; values that are tried."""

_ENDS: Final = np.concatenate(
    [LIMB_ENDS]
    + [[[JOINT_NAMES.index(f"{side}_{name}") for side in "rl"]] for name in ("shoulder", "hip")]
)
"""(12, 2): joints at the ends of LIMBS, of the line of the shoulders and of that of the hips."""


class Task(NamedTuple):
    """The match's inputs; the compiled function reads its members."""

    camera: Vector
    """(VIEW,)"""
    parts: Vector
    depth: float
    """The Stickman's arrays."""
    broad_px: float
    """The line of the shoulders of a person who faces the camera."""
    seen: Bits
    seen_px: int
    width: int
    """The silhouette, its number of pixels, and the width of the picture."""


def stick_similarity(sight: Sight, joints_m: NDArray[np.float64]) -> float:
    """S of the joints and the silhouette of a view.

    Args:
        sight: One view.
        joints_m: (15, 3) world; they may be off the pose's cylinders.
    """
    camera, man, person = undistorted_camera(sight.camera), sight.man, sight.person
    tall_px = _tall_px(camera, sight.stature_m, joints_m)
    seen, broad_px = words_of(person), 2 * man.lengths[HALF_SHOULDERS] * tall_px
    task = Task(view_of(camera), man.parts, man.depth, broad_px, seen, count(seen), person.width)
    stick = np.ones(POSE_SIZE)
    stick[STATURE] = tall_px
    best = 0.0
    for girth in GIRTHS:
        stick[GIRTH] = girth
        best = max(best, float(_similar(task, stick, joints_m)))
    return best


def _tall_px(camera: Camera, stature_m: float, joints_m: NDArray[np.float64]) -> float:
    """Height of the standing body in the picture at the pelvis's distance."""
    deep_m = float(arrays_of(camera).R[2] @ joints_m[PELVIS] + camera.t[2])
    return camera.K[1][1] * stature_m / max(deep_m, NEAREST_M)


@compiled
def _similar(task: Task, stick: Vector, joints_m: Floats) -> float:
    """S of the body with these joints; the visible breadth is written into `stick`."""
    ends = np.empty((12, 4))
    for row in range(12):
        for end in range(2):
            joint = _ENDS[row, end]
            x, y, z = joints_m[joint]
            ends[row, 2 * end], ends[row, 2 * end + 1], _ = seen_at(task.camera, x, y, z)
    line = ends[SHOULDER_LINE]
    across_px = math.hypot(line[2] - line[0], line[3] - line[1])
    stick[BREADTH] = min(1.0, across_px / task.broad_px)
    bits = np.zeros_like(task.seen)
    draw_segments(ends, stick, task.parts, task.depth, ALL_SEGMENTS, task.width, bits)
    return score(count_both(bits, task.seen), count(bits), task.seen_px)
