"""Where a moved camera stands, by exact landmarks of somebody who walks about and swings."""

import math

import msgspec
import numpy as np
import pytest
from staging import RIG, standing

from calibration.gate.moved_place import (
    PLACES,
    Person,
    Stood,
    _backdrop,
    _in_world,
    _of_person,
    placed,
)
from calibration.person.rig_evidence import Evidence
from calibration.person.rig_fit import Fit
from calibration.person.rig_starts import known_of
from calibration.tracks import person_prior as prior
from calibration.tracks import rig_guess
from calibration.tracks.joint_tracks import JointTrack, Sighting
from calibration.tracks.rig_guess import LATE, PLACE, Pinhole, guess_of, pinholes, rotation
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import ViewerNumber
from common.rig.camera import Rig, as_matrix, as_row, centre, project

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


def test_a_wall_ahead_shows_how_a_camera_was_turned_carried_and_rolled() -> None:
    """Worked by hand, in sigmas of 0.3 degrees: turned by 2 degrees, carried by 0.06 m to the
    right, 0.03 m down and 0.5 m ahead before a wall 6 m away, or rolled by 1.5 degrees."""
    before = Pinhole(200.0, rotation(0.4, 0.1, -0.05), np.array([0.3, 1.1, 2.0]))
    sigma = math.radians(0.3)

    def carried(turn: np.ndarray, by_m: tuple[float, float, float]) -> np.ndarray:
        place = before.centre_m + before.R.T @ np.array(by_m)
        return _backdrop(before, Pinhole(210.0, turn @ before.R, place), 6.0)

    assert carried(np.eye(3), (0.0, 0.0, 0.0)) == pytest.approx(np.zeros(3))
    aside = carried(np.eye(3), (0.06, 0.03, 0.5))
    assert aside == pytest.approx(np.array([-0.06 / 5.5, -0.03 / 5.5, 0.0]) / sigma)
    a = math.radians(2.0)
    yawed = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    assert carried(yawed, (0.0, 0.0, 0.0)) == pytest.approx([math.tan(a) / sigma, 0.0, 0.0])
    a = math.radians(1.5)
    rolled = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]])
    assert carried(rolled, (0.0, 0.0, 0.0)) == pytest.approx([0.0, 0.0, 5.0], abs=1e-9)


@pytest.mark.parametrize("turns", [False, True])
def test_a_fitted_rig_stands_in_the_world_of_the_one_before(turns: bool) -> None:
    """Camera 1 where it was; both against each other as the fit has them."""
    rig = moved(RIG, 1, (0.3, 0.1, -0.2), 25.0)
    start = np.concatenate([guess_of(rig), np.zeros(9)])
    guess = start.copy()
    guess[PLACE["yaw_2"]] += 0.1
    guess[PLACE["x_2"]] += 0.2
    guess[PLACE["height_2"]] -= 0.07
    if turns:
        guess[PLACE["pitch_1"]] += 0.05
        guess[PLACE["roll_1"]] -= 0.03
    found = _in_world(rig, start, guess)
    assert (found.cameras[0] == rig.cameras[0]) is not turns
    (was, _), (one, other) = pinholes(start), pinholes(guess)
    R_1, R_2 = (np.array(camera.R) for camera in found.cameras)
    c_1, c_2 = (centre(camera) for camera in found.cameras)
    assert c_1 == pytest.approx(centre(rig.cameras[0]))
    assert np.allclose(R_1 @ np.array(rig.cameras[0].R).T, one.R @ was.R.T)
    assert np.allclose(R_2 @ R_1.T, other.R @ one.R.T)
    assert R_1 @ (c_2 - c_1) == pytest.approx(one.R @ (other.centre_m - one.centre_m), abs=1e-9)
    assert [camera.K for camera in found.cameras] == [camera.K for camera in rig.cameras]


@pytest.mark.parametrize("both", [False, True])
def test_what_is_free_of_moved_cameras_and_how_sure_their_yaw_is(
    monkeypatch: pytest.MonkeyPatch, both: bool
) -> None:
    """A fit that knows its n-th number to n + 1 hundredths."""
    asked: list[tuple[str, ...]] = []

    def fit(start: np.ndarray, evidence: Evidence, free: np.ndarray) -> Fit:
        asked.append(tuple(name for name, at in PLACE.items() if free[at]))
        assert free[rig_guess.BODY].all()
        assert free[LATE]
        assert start[LATE] == evidence.known.mean[LATE] == 0.05
        assert [evidence.known.sigma[PLACE[name]] for name in PLACES] == list(PLACES.values())
        assert evidence.known.sigma[PLACE["roll_1"]] == math.radians(3.0)
        sigmas = 0.01 * (1.0 + np.arange(free.sum()))
        return Fit(
            start,
            0.0,
            (np.zeros((len(evidence.clips[0].first.times_s), 3), bool),),
            np.diag(1.0 / sigmas),
        )

    monkeypatch.setattr("calibration.gate.moved_place._fitted", fit)
    found = placed(RIG, seen_by(RIG), (1, 2) if both else (2,), 0.05)
    assert found is not None
    ahead = ("pitch_1", "roll_1") if both else ()
    assert asked == [(*ahead, "yaw_2", "pitch_2", "roll_2", "x_2", "height_2", "z_2")]
    assert found.turn_error_deg == pytest.approx(math.degrees(0.01 * (1 + len(ahead))))


def test_a_known_persons_soles_and_lengths_are_begun_with_and_believed() -> None:
    known = known_of(320, 1.75, 1)
    start = known.mean.copy()
    lengths = np.log([0.5, 0.3, 0.25, 0.24, 0.42, 0.4, 0.35, 0.2])
    begun, believed = _of_person(Person(lengths, 0.03), start, known)
    for name in PLACE:
        lower = 0.03 if name in ("height_1", "height_2") else 0.0
        assert begun[PLACE[name]] == start[PLACE[name]] - lower
        assert believed.mean[PLACE[name]] == known.mean[PLACE[name]] - lower
    assert begun[rig_guess.BODY] == pytest.approx(lengths)
    assert believed.mean[rig_guess.BODY] == pytest.approx(lengths)
    assert (believed.sigma[rig_guess.BODY] == 0.01).all()
    assert believed.stature_m == pytest.approx((0.5 + 0.3 + 0.42 + 0.4) / 0.952)
    assert known.mean[rig_guess.BODY] == pytest.approx(np.log(prior.SHARES * 1.75)), (
        "a value is no place"
    )


def test_the_background_is_half_as_far_again_as_the_person(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Half of the time the person stands 4 m before camera 2."""
    walls_m: list[float] = []

    def backdrop(before: Pinhole, camera: Pinhole, wall_m: float) -> np.ndarray:
        walls_m.append(wall_m)
        return np.zeros(3)

    monkeypatch.setattr("calibration.gate.moved_place._backdrop", backdrop)
    assert placed(RIG, seen_by(RIG), (2,), 0.0) is not None
    assert walls_m[0] == pytest.approx(1.5 * 4.0, abs=0.3)
