"""Where a moved camera stands, by exact landmarks of somebody who walks about and swings."""

import math

import msgspec
import numpy as np
import pytest
from staging import RIG, standing

from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import ViewerNumber
from common.rig.camera import Rig, as_matrix, as_row, centre, project
from integrator.rig_gate.moved_place import Stood, placed
from integrator.selfcalibration.joint_tracks import JointTrack, Sighting

WALL_M = 6.0
"""What a picture is turned by shows a step aside too."""
BODY = body_vector(thesis_bdp(1.75))


def moved(rig: Rig, viewer: ViewerNumber, by_m: tuple[float, float, float], yaw_deg: float) -> Rig:
    """With one camera carried away and turned."""
    camera = rig.cameras[viewer - 1]
    a = math.radians(yaw_deg)
    about = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    R = about @ np.array(camera.R)
    t = -R @ (centre(camera) + np.array(by_m))
    cameras = list(rig.cameras)
    cameras[viewer - 1] = msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t))
    return msgspec.structs.replace(rig, cameras=tuple(cameras))


def seen_by(rig: Rig) -> Sighting:
    rng = np.random.default_rng(3)
    poses = [
        standing(
            (0.5 * math.sin(n / 4), 0.4 * math.cos(n / 5)),
            r_shoulder_z=90 + 60 * math.sin(n / 3),
            l_shoulder_z=270 + 50 * math.cos(n / 3),
        )
        for n in range(60)
    ]
    joints_m = [np.asarray(joints(BODY, pose)) for pose in poses]
    at_s, sure = np.arange(60) / 15, np.full((60, 15), 0.9)
    tracks = []
    for camera, facing in zip(rig.cameras, (0.0, 90.0), strict=True):
        places = np.stack([project(camera, each) for each in joints_m])
        places += rng.normal(0, 0.4, places.shape)
        tracks.append(JointTrack(at_s, places, sure, np.full(60, facing), np.full(60, 0.95)))
    return Sighting(tracks[0], tracks[1], (rig.width, rig.height))


@pytest.mark.parametrize("viewer", [1, 2])
def test_a_camera_that_was_carried_is_found_and_the_other_stays(viewer: ViewerNumber) -> None:
    other: ViewerNumber = 2 if viewer == 1 else 1
    truth = moved(RIG, viewer, (0.12, 0.05, -0.1), 2.0)
    aside_m = (0.12, -0.1)[viewer - 1]
    pictured = moved(RIG, viewer, (0.0, 0.0, 0.0), 2.0 - math.degrees(aside_m / WALL_M))
    found = placed(pictured, seen_by(truth), (viewer,), 0.0, Stood(RIG, seen_by(RIG)))
    assert found is not None
    assert found.rig.cameras[other - 1] == RIG.cameras[other - 1]
    places = [joints_by(rig, truth) for rig in (pictured, found.rig)]
    assert places[1] < 0.75 * places[0]
    assert 0.0 < found.turn_error_deg < 3.0


def joints_by(rig: Rig, truth: Rig) -> float:
    """How far exact pixels triangulate from the truth, mm."""
    joints_m = np.asarray(joints(BODY, standing((0.2, -0.1))))
    rows = []
    for camera, real in zip(rig.cameras, truth.cameras, strict=True):
        P = np.array(camera.K) @ np.column_stack([np.array(camera.R), np.array(camera.t)])
        rows.append((P, project(real, joints_m)))
    found = []
    for n in range(len(joints_m)):
        system = np.concatenate([uv[n][:, None] * P[2] - P[:2] for P, uv in rows])
        point = np.linalg.svd(system)[2][-1]
        found.append(point[:3] / point[3])
    return 1e3 * float(np.linalg.norm(np.array(found) - joints_m, axis=1).mean())


def test_with_both_cameras_free_the_one_that_was_carried_is_found() -> None:
    truth = moved(RIG, 2, (0.0, 0.0, 0.1), 0.0)
    pictured = moved(RIG, 2, (0.0, 0.0, 0.0), -math.degrees(0.1 / WALL_M))
    found = placed(pictured, seen_by(truth), (1, 2), 0.0, Stood(RIG, seen_by(RIG)))
    assert found is not None
    assert joints_by(found.rig, truth) < 0.75 * joints_by(pictured, truth)


def test_too_little_that_is_seen_tells_nothing() -> None:
    seen = seen_by(RIG)
    few = seen._replace(first=JointTrack(*(part[:5] for part in seen.first)))
    assert placed(RIG, few, (2,), 0.0) is None
