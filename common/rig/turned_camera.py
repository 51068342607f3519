"""A camera turned in place: the shift of its picture from the turn, and the turn from the shift."""

import math

import cv2
import msgspec
import numpy as np

from common.body.body import Vector
from common.rig.camera import Camera, as_matrix, as_row
from common.rig.upright import Shift


def turn_of(shift: Shift, focal_px: Vector) -> Vector:
    """The turn (3, 3) of the scene, in the camera's axes, that shifts the picture so.

    Args:
        shift: How far the picture's middle moves, and how far the picture rolls about it.
        focal_px: (2,) focal lengths across and down.
    """
    ahead = np.array([shift.right_px / focal_px[0], shift.down_px / focal_px[1], 1.0])
    ahead /= np.linalg.norm(ahead)
    axis = np.cross([0.0, 0.0, 1.0], ahead)
    angle = math.atan2(float(np.linalg.norm(axis)), float(ahead[2]))
    swing = cv2.Rodrigues(axis * (angle / max(float(np.linalg.norm(axis)), 1e-12)))[0]
    roll = cv2.Rodrigues(np.array([0.0, 0.0, math.radians(shift.roll_deg)]))[0]
    return np.asarray(swing @ roll, float)


def shift_of(turn: Vector, focal_px: Vector) -> Shift:
    """The shift of a picture by a turn; the inverse of `turn_of`."""
    ahead = turn[:, 2] / turn[2, 2]
    level = Shift(float(ahead[0] * focal_px[0]), float(ahead[1] * focal_px[1]), 0.0)
    roll = turn_of(level, focal_px).T @ turn
    angle = math.degrees(math.atan2(float(roll[1, 0]), float(roll[0, 0])))
    return msgspec.structs.replace(level, roll_deg=angle)


def angle_deg(turn: Vector) -> float:
    """The angle of a turn (3, 3)."""
    return math.degrees(math.acos(max(-1.0, min(1.0, (float(np.trace(turn)) - 1.0) / 2.0))))


def turned(camera: Camera, turn: Vector) -> Camera:
    """The camera in place after the scene has turned by (3, 3) in its axes."""
    R, t = turn @ np.array(camera.R), turn @ np.array(camera.t)
    return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t))
