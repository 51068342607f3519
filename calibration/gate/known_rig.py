"""Tracks as the ideal cameras of the fit would show them."""

import cv2
import numpy as np

from calibration.tracks.joint_tracks import JointTrack, Sighting
from common.rig.camera import Camera, Rig


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
