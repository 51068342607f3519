"""A rig as a vector for the fit, and back."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.person_prior import LENGTHS
from common.body.body import Vector
from common.rig.camera import PAPER_ROTATIONS, Camera, Rig, as_matrix, as_row

NAMES: Final = (
    *("log_focal_1", "log_focal_2"),
    *("pitch_1", "roll_1", "height_1"),
    *("yaw_2", "pitch_2", "roll_2", "x_2", "height_2", "z_2"),
)
"""The numbers of a rig's vector. Camera 1 is above the world's origin and has no yaw, so it
looks towards -z; angles are radians, lengths metres. The vector continues with the lengths of
the person, then the delay of view 2 in each clip, seconds."""
PLACE: Final = {name: n for n, name in enumerate(NAMES)}
FOCALS: Final = slice(0, 2)
FARTHEST: Final = 20.0
"""Bound of the logarithm of a focal length in pixels: a step of the fit that diverges, and is
then taken back, stays finite at e^20."""
RIG: Final = len(NAMES)
BODY: Final = slice(RIG, RIG + len(LENGTHS))
"""Indices of the logarithms of the person's lengths, metres."""
LATE: Final = RIG + len(LENGTHS)
"""Index of the first delay."""


class Pinhole(NamedTuple):
    """One camera in the form of the fit."""

    focal_px: float
    R: NDArray[np.float64]
    """(3, 3) world to camera."""
    centre_m: Vector


def pinholes(guess: Vector) -> tuple[Pinhole, Pinhole]:
    """Both cameras of a vector."""
    focal_1, focal_2 = np.exp(guess[FOCALS].clip(-FARTHEST, FARTHEST)).tolist()
    pitch_1, roll_1, height_1, yaw_2, pitch_2, roll_2, x_2, height_2, z_2 = guess[2:RIG].tolist()
    return (
        Pinhole(focal_1, rotation(0.0, pitch_1, roll_1), np.array([0.0, height_1, 0.0])),
        Pinhole(focal_2, rotation(yaw_2, pitch_2, roll_2), np.array([x_2, height_2, z_2])),
    )


def rotation(yaw: float, pitch: float, roll: float) -> NDArray[np.float64]:
    """World to camera (3, 3): from a level view towards -z turned to the left about the vertical
    (yaw), then raised (pitch), then turned clockwise about the line of sight (roll); radians."""
    turned = np.array(PAPER_ROTATIONS[0]) @ _about(1, -yaw)
    level: NDArray[np.float64] = _about(2, -roll) @ _about(0, -pitch) @ turned
    return level


def _about(axis: int, angle: float) -> NDArray[np.float64]:
    """The rotation (3, 3) about a coordinate axis, right-handed."""
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[i, i] = turn[j, j] = cosine
    turn[j, i], turn[i, j] = sine, -sine
    return turn


def rig_of(cameras: tuple[Pinhole, Pinhole], size_px: tuple[int, int], origin_m: Vector) -> Rig:
    """Two cameras as a rig whose world has its origin at a place in theirs, (3,)."""
    told = []
    for name, one in zip(("cam1", "cam2"), cameras, strict=True):
        K = np.diag([one.focal_px, one.focal_px, 1.0])
        K[:2, 2] = np.array(size_px) / 2
        t = one.R @ (origin_m - one.centre_m)
        told.append(Camera(name, as_matrix(K), as_matrix(one.R), as_row(t)))
    return Rig(*size_px, tuple(told))
