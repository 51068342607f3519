"""A given rig as the fit knows rigs, held against vectors and pixels that are known."""

import math

import cv2
import msgspec
import numpy as np
import pytest

from calibration.gate.known_rig import as_ideal
from calibration.tracks.joint_tracks import JointTrack, Sighting
from calibration.tracks.rig_guess import RIG, guess_of, pinholes, rig_of
from common.rig.camera import Rig, as_matrix, as_row, paper_rig

GUESS = np.array([5.3, 5.6, -0.1, 0.07, 1.3, -1.1, 0.12, -0.05, -3.2, 1.6, -2.4])
"""Focal lengths of 200 and 270 px; every other number is another, too."""


def in_another_world(rig: Rig, yaw: float, to_m: tuple[float, float, float]) -> Rig:
    """The same cameras in a world that is turned about the vertical and moved."""
    turn = np.array(
        [
            [math.cos(yaw), 0.0, math.sin(yaw)],
            [0.0, 1.0, 0.0],
            [-math.sin(yaw), 0.0, math.cos(yaw)],
        ]
    )
    cameras = []
    for camera in rig.cameras:
        R = np.array(camera.R) @ turn
        t = np.array(camera.t) - R @ np.array(to_m)
        cameras.append(msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t)))
    return msgspec.structs.replace(rig, cameras=tuple(cameras))


@pytest.mark.parametrize("yaw", [0.0, 0.8, -2.0])
def test_a_rig_in_any_world_on_the_same_floor_is_its_vector(yaw: float) -> None:
    whole = np.concatenate([GUESS, np.zeros(9)])
    rig = rig_of(pinholes(whole), (320, 240), np.zeros(3))
    assert len(guess_of(rig)) == RIG
    found = guess_of(in_another_world(rig, yaw, (0.7, 0.0, -1.9)))
    off = found - GUESS
    off[5] = math.remainder(off[5], math.tau)
    assert off == pytest.approx(np.zeros(RIG), abs=1e-9)


def test_a_world_that_is_raised_has_both_cameras_higher() -> None:
    whole = np.concatenate([GUESS, np.zeros(9)])
    rig = rig_of(pinholes(whole), (320, 240), np.zeros(3))
    found = guess_of(in_another_world(rig, 0.0, (0.0, 0.25, 0.0))) - GUESS
    raised = np.zeros(RIG)
    raised[[4, 9]] = 0.25
    assert found == pytest.approx(raised, abs=1e-9)


def test_ideal_cameras_have_one_focal_length_no_distortion_and_their_middle_in_the_middle() -> None:
    """Pixels by OpenCV's own projection; the second camera bends no lines."""
    rig = paper_rig((320, 240), (200.0, 230.0), (4.0, 4.5))
    K = ((210.0, 0.0, 150.0), (0.0, 190.0, 125.0), (0.0, 0.0, 1.0))
    bent = msgspec.structs.replace(rig.cameras[0], K=K, distortion=(-0.2, 0.05, 0.001, 0.002, 0.0))
    aside = ((230.0, 0.0, 170.0), (0.0, 240.0, 110.0), (0.0, 0.0, 1.0))
    straight = msgspec.structs.replace(rig.cameras[1], K=aside)
    points = np.random.default_rng(2).uniform((-0.5, -0.4, 3.0), (0.5, 0.4, 5.0), (2, 15, 3))
    nothing = np.zeros(2)
    tracks = []
    for camera in (bent, straight):
        lens = np.array(camera.distortion or (0.0,) * 5)
        pixels = cv2.projectPoints(
            points.reshape(-1, 3), np.zeros(3), np.zeros(3), np.array(camera.K), lens
        )[0].reshape(2, 15, 2)
        tracks.append(JointTrack(nothing, pixels, np.full((2, 15), 0.9), nothing, nothing))
    given = Sighting(tracks[0], tracks[1], (320, 240))
    found = as_ideal(given, msgspec.structs.replace(rig, cameras=(bent, straight)))
    flat = points[..., :2] / points[..., 2:]
    assert found.first.joints_px == pytest.approx(210.0 * flat + [160.0, 120.0], abs=1e-3)
    assert found.second.joints_px == pytest.approx(230.0 * flat + [160.0, 120.0], abs=1e-6)
    assert found.size_px == (320, 240)
    empty = given._replace(first=JointTrack(*(part[:0] for part in given.first)))
    assert as_ideal(empty, rig).first is empty.first
