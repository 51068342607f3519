"""A film's joints smoothed from both ends: held against filterpy, and against a rigid body."""

from collections.abc import Sequence

import msgspec
import numpy as np
import pytest
from filterpy.common import Q_discrete_white_noise
from filterpy.kalman import KalmanFilter

from common.body.body import JOINT_NAMES, LIMB_ENDS, POSE_INDEX, rest_pose
from common.body.extremities import EXTREMITY_NAMES, extremities
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import Body
from common.notes.notes import Note, Notes
from common.rig.camera import paper_rig, project
from runtime.offline.video_smoothing import (
    ACCELERATION_M_S2,
    NOISE_M,
    START_SPEED_M_S,
    calmed,
    smoothed,
    steadied,
)

RIG = paper_rig((320, 240), (400.0, 400.0), (4.5, 4.5))
N = 60
TIME_S = np.arange(N) / 25
BDP = thesis_bdp(1.75)
TOE = EXTREMITY_NAMES.index("l_toe")


def test_places_are_smoothed_as_filterpy_smooths_them() -> None:
    """Its filter and its smoother, step by step, at a rate and with a noise that vary."""
    rng = np.random.default_rng(8)
    time_s = np.cumsum(rng.choice([0.02, 0.04, 0.1], 30))
    variances = NOISE_M**2 * rng.choice([1.0, 30.0], (30, 1))
    seen = np.cumsum(rng.normal(0.0, 0.1, 30))
    reference = KalmanFilter(dim_x=2, dim_z=1)
    reference.H = np.array([[1.0, 0.0]])
    reference.x = np.array([[seen[0]], [0.0]])
    reference.P = np.diag([variances[0, 0], START_SPEED_M_S**2])
    states, steps = [(reference.x.copy(), reference.P.copy())], []
    for gap_s, place, variance in zip(np.diff(time_s), seen[1:], variances[1:], strict=True):
        steps.append(
            (
                np.array([[1.0, gap_s], [0.0, 1.0]]),
                Q_discrete_white_noise(2, gap_s, ACCELERATION_M_S2**2),
            )
        )
        reference.predict(F=steps[-1][0], Q=steps[-1][1])
        reference.update(place, R=float(variance[0]))
        states.append((reference.x.copy(), reference.P.copy()))
    X, P = (np.array(each) for each in zip(*states, strict=True))
    F, Q = (list(each) for each in zip((np.eye(2), np.zeros((2, 2))), *steps, strict=True))
    found = reference.rts_smoother(X, P, F, Q)[0][:, 0, 0]
    assert smoothed(seen[:, None], time_s, variances)[:, 0] == pytest.approx(found, abs=1e-9)


def test_who_moves_evenly_is_left_alone() -> None:
    ramp = 1.3 * TIME_S[:, None]
    assert np.abs(steadied(ramp, TIME_S) - ramp)[5:-5].max() < 0.005


def test_a_joint_that_jumps_aside_for_a_moment_does_not_pull_the_frames_around_it() -> None:
    """Two wrong frames in sixty: without them, it is where it was."""
    still = np.zeros((N, 2, 3))
    jumps = still.copy()
    jumps[30:32, 0, 0] = 0.6
    found = steadied(jumps, TIME_S)
    plainly = smoothed(jumps, TIME_S, np.full((N, 1, 1), NOISE_M**2))
    beside = np.r_[24:30, 32:38]
    assert np.abs(found[beside, 0, 0]).max() < 0.25 * np.abs(plainly[beside, 0, 0]).max()
    assert np.abs(found[:, 1]).max() == 0.0


def swinging() -> np.ndarray:
    """Joints (N, 15, 3) of a rigid body that swings an arm once a second."""
    every = []
    for moment_s in TIME_S:
        pose = rest_pose()
        pose[POSE_INDEX["l_shoulder_x"]] = 40.0 * np.sin(2 * np.pi * moment_s)
        pose[POSE_INDEX["y"]] = 0.9
        every.append(joints(body_vector(BDP), pose))
    return np.array(every)


def bodies_of(joints_m: np.ndarray, unseen: tuple[int, ...] = ()) -> list[Body]:
    bodies = []
    for n, each in enumerate(joints_m):
        body = Body(frame=n, captured_s=TIME_S[n], clock_s=TIME_S[n], status="empty", views="none")
        if n not in unseen:
            body = Body(
                **{name: getattr(body, name) for name in ("frame", "captured_s", "clock_s")},
                status="tracking",
                views="1",
                bdp=BDP,
                joints_m=tuple(tuple(place) for place in each.tolist()),
                extremities_m=tuple(tuple(place) for place in extremities(each, 1.75).tolist()),
                joints_px=tuple(
                    tuple(tuple(pixel) for pixel in project(camera, each).tolist())
                    for camera in RIG.cameras
                ),
            )
        bodies.append(body)
    return bodies


def shaken(joints_m: np.ndarray) -> np.ndarray:
    noise = np.random.default_rng(3).normal(0.0, 0.03, joints_m.shape)
    return np.asarray(joints_m + noise)


def places(bodies: Sequence[Body]) -> np.ndarray:
    return np.array([body.joints_m for body in bodies])


def test_a_shaken_body_is_nearer_to_the_true_one_calm_and_rigid() -> None:
    true_m = swinging()
    shaky, calm = bodies_of(shaken(true_m)), calmed(bodies_of(shaken(true_m)), RIG)

    def off(bodies: Sequence[Body]) -> float:
        return float(np.linalg.norm(places(bodies) - true_m, axis=2).mean())

    def jerk(joints_m: np.ndarray) -> float:
        return float(np.percentile(np.linalg.norm(np.diff(joints_m, 2, axis=0), axis=2), 95))

    assert off(calm) < 0.7 * off(shaky)
    assert jerk(places(calm)) < 0.3 * jerk(places(shaky))
    ends = places(calm)[:, LIMB_ENDS]
    lengths_m = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2)
    assert np.ptp(lengths_m, axis=0).max() < 1e-9


def test_joints_in_the_picture_are_those_in_space() -> None:
    for body in calmed(bodies_of(shaken(swinging())), RIG):
        every = zip(RIG.cameras, body.joints_px, body.extremities_px, strict=True)
        for camera, pixels, further_px in every:
            assert np.array(pixels) == pytest.approx(project(camera, np.array(body.joints_m)))
            ends_px = project(camera, np.array(body.extremities_m))
            assert np.array(further_px) == pytest.approx(ends_px)


def test_feet_hands_and_nose_go_where_their_joints_go() -> None:
    """A leg that jumps aside for two frames is taken back, and its foot with it."""
    jumps = swinging()
    leg = [JOINT_NAMES.index(name) for name in ("l_knee", "l_ankle")]
    jumps[30:32, leg, 0] += 0.6
    for body in calmed(bodies_of(jumps), RIG):
        by_rule_m = extremities(np.array(body.joints_m), 1.75)
        assert np.array(body.extremities_m) == pytest.approx(by_rule_m, abs=1e-6)


def test_a_toe_measured_off_the_rule_stays_off_it_and_one_that_jumps_does_not() -> None:
    """A foot that is held turned by 8 cm; a frame in which it is seen 20 cm further out."""
    turned = [
        msgspec.structs.replace(body, extremities_m=moved(body, 0.28 if n == 30 else 0.08))
        for n, body in enumerate(bodies_of(swinging()))
    ]
    calm = calmed(turned, RIG)
    off_m = [
        (body.extremities_m[TOE] - extremities(np.array(body.joints_m), 1.75)[TOE])[0]
        for body in calm
    ]
    assert np.array(off_m) == pytest.approx(0.08, abs=0.03)


def moved(body: Body, by_m: float) -> tuple[tuple[float, float, float], ...]:
    """The extremities, the left toe moved aside."""
    places = [*body.extremities_m]
    x, y, z = places[TOE]
    places[TOE] = (x + by_m, y, z)
    return tuple(places)


def test_who_was_away_is_met_afresh() -> None:
    """What comes after a gap tells nothing of what was before it; frames of nobody stay so."""
    there = swinging()
    there[30:] += 1.0
    film = calmed(bodies_of(there, unseen=(29,)), RIG)
    assert film[29].joints_m == ()
    alone = calmed(bodies_of(there)[:29], RIG)
    assert places(film[:29]) == pytest.approx(places(alone), abs=2e-3)
    nobody = bodies_of(there, unseen=tuple(range(N)))
    assert calmed(nobody, RIG) == nobody


def test_a_joint_stays_where_the_user_put_it() -> None:
    """T21: from the frame of the note on."""
    wrist = JOINT_NAMES.index("r_wrist")
    shaky = bodies_of(shaken(swinging()))
    notes = Notes(note=(Note(20, joints_px={"r_wrist": (100.0, 100.0)}),))
    calm = calmed(shaky, RIG, notes)
    kept = [a.joints_m[wrist] == b.joints_m[wrist] for a, b in zip(shaky, calm, strict=True)]
    assert kept == [n >= 20 for n in range(N)]


def test_one_frame_is_a_film() -> None:
    (body,) = calmed(bodies_of(swinging()[:1]), RIG)
    assert np.array(body.joints_m) == pytest.approx(swinging()[0], abs=1e-6)
