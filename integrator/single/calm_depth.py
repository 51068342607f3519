"""Depth of the joints in a single view: no more motion than the picture shows."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector

COMMON_M: Final = 0.015
"""Standard deviation of a proposed distance that all joints share: the whole body's."""
OWN_M: Final = 0.006
"""Standard deviation of each joint's own proposed distance."""
SMOOTH_S: Final = 0.13
"""Time constant by which lines of sight are smoothed, to see whether they move."""
TREMOR_M_S: Final = 0.04
"""Apparent speed of smoothed lines of sight, metres per second at the joints, for a person who
stands still."""
DEEPER: Final = 24.0
"""Ratio of the speed along the line of sight that is allowed, for a joint or the body, to its
speed across: a person who walks towards the camera hardly moves across. With a smaller ratio
synthetic people who walk so lag; with a larger one standing people tremble."""
DRIFT_M: Final = 0.004
"""Standard deviation of a distance's unseen drift in a second (random walk)."""
SURPRISE: Final = 3.0
"""Standard deviations from the prediction up to which a distance is noise; beyond, it changed."""
ALL: Final = len(JOINT_NAMES)
NOISE: Final = COMMON_M**2 + OWN_M**2 * np.eye(ALL)
"""(15, 15) m^2, covariance of the proposed distances."""


class Memory(NamedTuple):
    """Memory of the instant before."""

    rays: NDArray[np.float64]
    """(15, 3) smoothed lines of sight from the camera to each joint."""
    range_m: Vector
    """(15,) distance of each joint."""
    P: NDArray[np.float64]
    """(15, 15) m^2, covariance of the distances."""


def step(
    memory: Memory | None, eye_m: Vector, joints_m: NDArray[np.float64], dt_s: float
) -> tuple[Memory, NDArray[np.float64]]:
    """One instant: joints moved along their lines of sight to their most probable distances.

    A picture shows the directions of joints. Their distances are proposed anew at each instant, and
    tremble while a person stands still, the whole body's by a centimetre. A joint that does not
    move in the picture hardly comes nearer. So a distance may change by DEEPER times the motion
    across the line of sight, of its joint or of all on average. A larger deviation is believed
    nevertheless: an arm may be stretched straight towards the camera.

    Args:
        memory: None at the first instant.
        eye_m: (3,) place of the camera.
        joints_m: (15, 3) as proposed.
        dt_s: Time since the instant before.

    Returns:
        The new memory, and the joints (15, 3).
    """
    from filterpy.kalman import predict, update  # a second's import: two views need none

    off_m = joints_m - eye_m
    range_m = np.linalg.norm(off_m, axis=1)
    rays = off_m / range_m[:, np.newaxis]
    if memory is None:
        return Memory(rays, range_m, NOISE), joints_m
    turn = (1.0 - math.exp(-dt_s / SMOOTH_S)) * (rays - memory.rays)
    across_m = np.linalg.norm(turn, axis=1) * range_m
    along_m = DEEPER * np.maximum(0.0, across_m - TREMOR_M_S * dt_s)
    drift = DRIFT_M**2 * dt_s
    change = np.diag(along_m**2 + drift) + along_m.mean() ** 2 + drift
    foreseen_m, P = predict(memory.range_m, memory.P, 1, change)
    apart_m = range_m - foreseen_m
    beyond_m = np.maximum(0.0, np.abs(apart_m) - SURPRISE * np.sqrt(np.diag(P + NOISE)))
    jump_m = np.copysign(beyond_m, apart_m)
    found_m, P = update(foreseen_m, P + np.outer(jump_m, jump_m), range_m, NOISE, np.eye(ALL))
    return Memory(memory.rays + turn, found_m, P), eye_m + rays * found_m[:, np.newaxis]
