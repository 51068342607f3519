"""Depth of a whole body in a single view: by feet on the floor, and no faster than people walk."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, POSE_INDEX, Vector
from common.body.observation import Landmarks
from common.rig.camera import Camera, arrays_of, centre, ray
from integrator.rig.undistortion import undistorted_camera
from integrator.single.sight import Hypothesis, Sight

PROPOSED_M: Final = 0.16
"""Standard deviation of the depth of a body whose size in the picture tells it."""
FEET_M: Final = 0.1
"""Standard deviation of the depth of the middle of two feet side by side on the floor."""
LIFTED: Final = 0.3
"""What it grows by with the distance of the feet along the view: one may be lifted, and appears
beyond its place."""
KNOWN_M: Final = 0.05
"""The same of a body that two views showed in the instant before."""
WALK_M: Final = 0.3
"""By how much a depth changes in a second, as a random walk: .08 m in a fifteenth of it."""
STRIDE_M: Final = 0.9
"""Distance of two feet along the view above which one is lifted."""
ANKLE: Final = 0.047
"""Height of an ankle above the floor, statures."""
SURE: Final = 0.3
"""Confidence from which on an ankle counts."""
SURPRISE: Final = 2.0
"""Standard deviations from what is foreseen beyond which both are believed less."""
ANKLES: Final = tuple(JOINT_NAMES.index(name) for name in ("l_ankle", "r_ankle"))
PELVIS: Final = JOINT_NAMES.index("pelvis")
PLACE: Final = [POSE_INDEX[name] for name in ("x", "y", "z")]


class Memory(NamedTuple):
    """A depth of the pelvis, and how sure it is."""

    depth_m: float
    """From the camera's plane, along its axis."""
    variance_m2: float


def known(camera: Camera, joints_m: NDArray[np.float64]) -> Memory:
    """The memory of a body (15, 3) that two views showed in the instant before."""
    return Memory(_depth_m(camera, joints_m[PELVIS]), KNOWN_M**2)


def step(memory: Memory | None, sight: Sight, body: Hypothesis) -> tuple[Memory, Hypothesis]:
    """One instant: the body, moved along its line of sight to its most probable depth.

    A silhouette tells the depth by its size, and wrongly where others hide a part of the person.
    The floor tells it where both feet are seen.

    Args:
        memory: None at the first instant.
        sight: The view, of a rig whose floor is known.
        body: As proposed.
    """
    camera = undistorted_camera(sight.camera)
    proposed_m = _depth_m(camera, body.joints_m[PELVIS])
    feet = feet_depth(camera, sight.person.landmarks, ANKLE * sight.stature_m)
    shown = [Memory(proposed_m, PROPOSED_M**2)] + ([] if feet is None else [feet])
    if memory is not None:
        memory = memory._replace(variance_m2=memory.variance_m2 + WALK_M**2 * sight.dt_s)
    after = _weighed(memory, shown)
    off_m = body.joints_m[PELVIS] - centre(camera)
    by_m = off_m * (after.depth_m / proposed_m - 1.0)
    pose = body.pose.copy()
    pose[PLACE] += by_m
    return after, body._replace(joints_m=body.joints_m + by_m, pose=pose)


def feet_depth(camera: Camera, shown: Landmarks | None, ankle_m: float) -> Memory | None:
    """Depth of the middle of two feet on the floor; None where both are not seen there.

    Args:
        camera: Without distortion.
        shown: The person's landmarks.
        ankle_m: Height of an ankle.
    """
    if shown is None or min(shown.confidence[ankle] for ankle in ANKLES) < SURE:
        return None
    eye_m = centre(camera)
    depths_m = []
    for ankle in ANKLES:
        along = ray(camera, shown.joints_px[ankle])
        share = (ankle_m - eye_m[1]) / along[1] if along[1] else -1.0
        depths_m.append(_depth_m(camera, eye_m + share * along))
    apart_m = abs(depths_m[0] - depths_m[1])
    if min(depths_m) <= 0.0 or apart_m > STRIDE_M:
        return None
    return Memory(float(np.mean(depths_m)), FEET_M**2 + (LIFTED * apart_m) ** 2)


def _weighed(memory: Memory | None, shown: Sequence[Memory]) -> Memory:
    """The mean of depths, weighed by their variances; one far from what is foreseen makes both
    uncertain."""
    for depth_m, variance_m2 in shown:
        if memory is None:
            memory = Memory(depth_m, variance_m2)
            continue
        off_m, both_m2 = depth_m - memory.depth_m, memory.variance_m2 + variance_m2
        far_m2 = max(0.0, (off_m / SURPRISE) ** 2 - both_m2)
        gain = (memory.variance_m2 + 0.5 * far_m2) / (both_m2 + far_m2)
        memory = Memory(memory.depth_m + gain * off_m, gain * (variance_m2 + 0.5 * far_m2))
    assert memory is not None  # a body is always proposed
    return memory


def _depth_m(camera: Camera, place_m: Vector) -> float:
    known = arrays_of(camera)
    return float(known.R[2] @ (place_m - known.centre))
