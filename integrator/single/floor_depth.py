"""Depth of a whole body in a single view: by feet on the floor, and no faster than people walk."""

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
WALK_M_S: Final = 0.8
"""Standard deviation of the speed towards or from the camera, of whom nothing is known."""
STARTS_M_S2: Final = 4.0
"""The same of its change in a second: people stop within a step."""
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


class Depth(NamedTuple):
    """A depth of the pelvis, from the camera's plane, along its axis, and how sure it is."""

    depth_m: float
    variance_m2: float


class Memory(NamedTuple):
    """The depth after an instant."""

    state: Vector
    """(2,) the depth, metres, and its speed, metres a second."""
    P: NDArray[np.float64]
    """(2, 2) their covariance."""

    @property
    def depth_m(self) -> float:
        """The depth alone."""
        return float(self.state[0])


def known(camera: Camera, joints_m: NDArray[np.float64]) -> Memory:
    """The memory of a body (15, 3) that two views showed in the instant before."""
    return _begun(Depth(_depth_m(camera, joints_m[PELVIS]), KNOWN_M**2))


def step(
    memory: Memory | None, sight: Sight, body: Hypothesis, lifted_m: Vector | None = None
) -> tuple[Memory, Hypothesis]:
    """One instant: the body, moved along its line of sight to its most probable depth.

    A silhouette tells the depth by its size: where others are in it, it is too large, and the depth
    too small. Landmarks tell it by their size too: the larger of both depths counts. The floor
    tells it where both feet are seen.

    Args:
        memory: None at the first instant.
        sight: The view, of a rig whose floor is known.
        body: As proposed.
        lifted_m: (3,) the middle of the hips by the landmarks alone; None: they show none.
    """
    camera = undistorted_camera(sight.camera)
    proposed_m = _depth_m(camera, body.joints_m[PELVIS])
    size_m = proposed_m if lifted_m is None else max(proposed_m, _depth_m(camera, lifted_m))
    feet = feet_depth(camera, sight.person.landmarks, ANKLE * sight.stature_m)
    shown = [Depth(size_m, PROPOSED_M**2)] + ([] if feet is None else [feet])
    after = _begun(shown.pop(0)) if memory is None else _foreseen(memory, sight.dt_s)
    for each in shown:
        after = _with(after, each)
    off_m = body.joints_m[PELVIS] - centre(camera)
    by_m = off_m * (after.depth_m / proposed_m - 1.0)
    pose = body.pose.copy()
    pose[PLACE] += by_m
    return after, body._replace(joints_m=body.joints_m + by_m, pose=pose)


def feet_depth(camera: Camera, shown: Landmarks | None, ankle_m: float) -> Depth | None:
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
    return Depth(float(np.mean(depths_m)), FEET_M**2 + (LIFTED * apart_m) ** 2)


def _begun(first: Depth) -> Memory:
    return Memory(np.array((first.depth_m, 0.0)), np.diag((first.variance_m2, WALK_M_S**2)))


def _foreseen(memory: Memory, dt_s: float) -> Memory:
    """The depth after some time at its speed."""
    onward = np.array(((1.0, dt_s), (0.0, 1.0)))
    noise = STARTS_M_S2 * np.array((0.5 * dt_s**2, dt_s))
    P = onward @ memory.P @ onward.T + np.outer(noise, noise)
    return Memory(onward @ memory.state, P)


def _with(memory: Memory, shown: Depth) -> Memory:
    """The depth with what an instant shows; one far from what is foreseen makes both uncertain."""
    off_m, both_m2 = shown.depth_m - memory.depth_m, memory.P[0, 0] + shown.variance_m2
    far_m2 = max(0.0, (off_m / SURPRISE) ** 2 - both_m2)
    P = memory.P.copy()
    P[0, 0] += 0.5 * far_m2
    gain = P[:, 0] / (both_m2 + far_m2)
    return Memory(memory.state + gain * off_m, P - np.outer(gain, P[0]))


def _depth_m(camera: Camera, place_m: Vector) -> float:
    known = arrays_of(camera)
    return float(known.R[2] @ (place_m - known.centre))
