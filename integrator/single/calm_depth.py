"""How far away the joints of one view are: as calm as the picture is."""

import math
from typing import Final, NamedTuple

import numpy as np
from filterpy.kalman import predict, update
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector

COMMON_M: Final = 0.015
"""Standard deviation of a proposed distance that all joints share: of the whole body's."""
OWN_M: Final = 0.006
"""Standard deviation of a proposed distance that each joint has besides."""
SMOOTH_S: Final = 0.13
"""Time constant by which lines of sight are smoothed, to see whether they move."""
TREMOR_M_S: Final = 0.04
"""How fast smooth lines of sight seem to move, at the joints of a person who stands still."""
DEEPER: Final = 24.0
"""How many times as far as it moves across the line of sight a joint, or the body, may move along
it: who walks towards the camera hardly moves across it. With fewer, made-up people who walk so lag;
with more, those who stand tremble."""
DRIFT_M: Final = 0.004
"""How far a distance drifts unseen in a second, standard deviation of a random walk."""
SURPRISE: Final = 3.0
"""Standard deviations off the prediction up to which a distance is noise: beyond, it changed."""
ALL: Final = len(JOINT_NAMES)
NOISE: Final = COMMON_M**2 + OWN_M**2 * np.eye(ALL)
"""(15, 15) m^2, covariance of the proposed distances."""


class Memory(NamedTuple):
    """What is remembered of the instant before."""

    rays: NDArray[np.float64]
    """(15, 3) smooth lines of sight from the camera to each joint."""
    range_m: Vector
    """(15,) how far away each is."""
    P: NDArray[np.float64]
    """(15, 15) m^2, covariance of the ranges."""


def step(
    memory: Memory | None, eye_m: Vector, joints_m: NDArray[np.float64], dt_s: float
) -> tuple[Memory, NDArray[np.float64]]:
    """One instant: joints moved along their lines of sight, to where they are most probably.

    A picture says where joints are in it. How far away they are is proposed anew at each instant,
    and trembles, the whole body by a centimetre, while a person stands still. What does not move
    in the picture hardly comes nearer: a distance may change as far as its joint, or all of them on
    the average, move across the line of sight, times DEEPER. What is far off nevertheless is
    believed: an arm may be stretched straight towards the camera.

    Args:
        memory: None at the first instant.
        eye_m: (3,) where the camera stands.
        joints_m: (15, 3) as proposed.
        dt_s: Time since the instant before.

    Returns:
        What is to be remembered, and the joints (15, 3).
    """
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
