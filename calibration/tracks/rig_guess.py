"""A rig as a vector for the fit, and back."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.person_prior import LENGTHS
from common.body.body import Vector
from common.rig.camera import PAPER_ROTATIONS, Camera, Rig, as_matrix, as_row, centre

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


def guess_of(rig: Rig) -> Vector:
    """(RIG,) the vector of two cameras, in a world where camera 1 is above the origin and has no
    yaw."""
    turns = [_turn_of(camera) for camera in rig.cameras]
    places = [centre(camera) for camera in rig.cameras]
    yaw = turns[0][0]
    base = places[1] - places[0]
    x = math.cos(yaw) * base[0] - math.sin(yaw) * base[2]
    z = math.sin(yaw) * base[0] + math.cos(yaw) * base[2]
    guess = np.empty(RIG)
    guess[:2] = [math.log(camera.K[0][0]) for camera in rig.cameras]
    guess[2:5] = (*turns[0][1:], places[0][1])
    guess[5:] = (turns[1][0] - yaw, *turns[1][1:], x, places[1][1], z)
    return guess


def _turn_of(camera: Camera) -> tuple[float, float, float]:
    """Yaw, pitch and roll, radians, as `rotation` takes them."""
    R = np.array(camera.R)
    forward = R[2]
    yaw = math.atan2(-forward[0], -forward[2])
    pitch = math.asin(max(-1.0, min(1.0, float(forward[1]))))
    level = np.array([math.cos(yaw), 0.0, -math.sin(yaw)])
    roll = math.atan2(-float(R[1] @ level), float(R[0] @ level))
    return yaw, pitch, roll


def rig_of(cameras: Sequence[Pinhole], size_px: tuple[int, int], origin_m: Vector) -> Rig:
    """Cameras as a rig whose world has its origin at a place in theirs, (3,)."""
    told = []
    for number, one in enumerate(cameras, start=1):
        K = np.diag([one.focal_px, one.focal_px, 1.0])
        K[:2, 2] = np.array(size_px) / 2
        t = one.R @ (origin_m - one.centre_m)
        told.append(Camera(f"cam{number}", as_matrix(K), as_matrix(one.R), as_row(t)))
    return Rig(*size_px, tuple(told))
