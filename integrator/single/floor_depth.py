"""Depth of a whole body in a single view: by feet on the floor, and no faster than people walk."""

import math
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
LASTS: Final = 0.5
"""Share of its variance that is the same in every instant of a person: by their build, their
clothes, who hides them."""
LASTS_S: Final = 4.0
"""Time in which that share is another, seconds."""
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
BY_SIZE: Final = np.array((1.0, 0.0, 1.0))
BY_FEET: Final = np.array((1.0, 0.0, 0.0))
"""Which of the memory's values add up to what a person's size, and feet, tell."""
PLACE: Final = [POSE_INDEX[name] for name in ("x", "y", "z")]


class Depth(NamedTuple):
    """A depth of the pelvis, from the camera's plane, along its axis, and how sure it is."""

    depth_m: float
    variance_m2: float


class Memory(NamedTuple):
    """The depth after an instant."""

    state: Vector
    """(3,) the depth, metres, its speed, metres a second, and by how much farther the person's size
    says that they are, metres."""
    P: NDArray[np.float64]
    """(3, 3) their covariance."""

    @property
    def depth_m(self) -> float:
        """The depth alone."""
        return float(self.state[0])


def known(camera: Camera, joints_m: NDArray[np.float64]) -> Memory:
    """The memory of a body (15, 3) that two views showed in the instant before."""
    return _begun(Depth(_depth_m(camera, joints_m[PELVIS]), KNOWN_M**2))


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
    if memory is None:
        after = _begun(Depth(proposed_m, (1.0 - LASTS) * PROPOSED_M**2), by_size=True)
    else:
        told = Depth(proposed_m, (1.0 - LASTS) * PROPOSED_M**2)
        after = _with(_foreseen(memory, sight.dt_s), told, BY_SIZE)
    if feet is not None:
        after = _with(after, feet, BY_FEET)
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


def _begun(first: Depth, *, by_size: bool = False) -> Memory:
    """The memory at the first instant, of a depth that two views or the person's size tell."""
    lasting_m2 = LASTS * PROPOSED_M**2
    P = np.diag((first.variance_m2, WALK_M_S**2, lasting_m2))
    if by_size:
        P[0, 0] += lasting_m2
        P[0, 2] = P[2, 0] = -lasting_m2
    return Memory(np.array((first.depth_m, 0.0, 0.0)), P)


def _foreseen(memory: Memory, dt_s: float) -> Memory:
    """The depth after some time at its speed."""
    kept = math.exp(-dt_s / LASTS_S)
    onward = np.array(((1.0, dt_s, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, kept)))
    noise = STARTS_M_S2 * np.array((0.5 * dt_s**2, dt_s, 0.0))
    P = onward @ memory.P @ onward.T + np.outer(noise, noise)
    P[2, 2] += (1.0 - kept**2) * LASTS * PROPOSED_M**2
    return Memory(onward @ memory.state, P)


def _with(memory: Memory, shown: Depth, by: Vector) -> Memory:
    """The depth with what an instant shows; one far from what is foreseen makes both uncertain.

    Args:
        memory: As foreseen.
        shown: A sum of the state's.
        by: BY_SIZE or BY_FEET.
    """
    off_m = shown.depth_m - float(by @ memory.state)
    both_m2 = float(by @ memory.P @ by) + shown.variance_m2
    far_m2 = max(0.0, (off_m / SURPRISE) ** 2 - both_m2)
    P = memory.P.copy()
    P[0, 0] += 0.5 * far_m2
    gain = P @ by / (both_m2 + far_m2)
    return Memory(memory.state + gain * off_m, P - np.outer(gain, by @ P))


def _depth_m(camera: Camera, place_m: Vector) -> float:
    known = arrays_of(camera)
    return float(known.R[2] @ (place_m - known.centre))
