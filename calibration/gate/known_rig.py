"""A given rig in the form of the fit: its vector, and tracks as ideal cameras would show them."""

import math

import cv2
import numpy as np

from calibration.tracks.joint_tracks import JointTrack, Sighting
from calibration.tracks.rig_guess import RIG
from common.body.body import Vector
from common.rig.camera import Camera, Rig, centre


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
    """Yaw, pitch and roll, radians, as `rig_guess.rotation` takes them."""
    R = np.array(camera.R)
    forward = R[2]
    yaw = math.atan2(-forward[0], -forward[2])
    pitch = math.asin(max(-1.0, min(1.0, float(forward[1]))))
    level = np.array([math.cos(yaw), 0.0, -math.sin(yaw)])
    roll = math.atan2(-float(R[1] @ level), float(R[0] @ level))
    return yaw, pitch, roll


def as_ideal(sighting: Sighting, rig: Rig) -> Sighting:
    """The tracks as cameras without distortion, with one focal length and a central principal
    point, would show them."""
    first, second = (
        _ideal_track(track, camera, sighting.size_px)
        for track, camera in zip((sighting.first, sighting.second), rig.cameras, strict=True)
    )
    return Sighting(first, second, sighting.size_px)


def _ideal_track(track: JointTrack, camera: Camera, size_px: tuple[int, int]) -> JointTrack:
    if not len(track.times_s):
        return track
    distortion = np.array(camera.distortion) if any(camera.distortion) else None
    flat = cv2.undistortPoints(track.joints_px.reshape(-1, 1, 2), np.array(camera.K), distortion)
    ideal = camera.K[0][0] * flat.reshape(track.joints_px.shape) + np.array(size_px) / 2
    return track._replace(joints_px=ideal)
