"""Random pairs of cameras calibrated by made-up people: how many are found, and how honestly.

    .venv/bin/python benchmarks/wild_rigs.py --pairs 200

Geometry alone: joints are projected and spoiled as the network of landmarks spoils them, by errors
that last, and sides that are exchanged for a while.
"""

import argparse
import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, OTHER_SIDE, Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre, project
from common.rig.rig_file import CalibrationError
from integrator.selfcalibration.joint_tracks import JointTrack, Sighting
from integrator.selfcalibration.person_calibration import calibrated_by_person
from integrator.selfcalibration.rig_guess import rotation
from integrator.selfcalibration.rig_quality import PersonCalibration
from synth.motion.motions import POSTURES, Motion, performance
from synth.person.people import person
from synth.person.skeleton import JOINTS

AT: Final = [JOINTS.index(name) for name in JOINT_NAMES]
SIZE: Final = (160, 120)
APART_DEG, HEIGHTS_M, FOCALS = (50.0, 130.0), (0.5, 3.0), (0.6, 1.5)
ROLL_DEG, AIM_M = 4.0, 0.15
FILLS: Final = (0.5, 0.75)
"""How much of the picture's height the person takes."""
LASTING: Final = 0.8
"""What is left of a landmark's error a frame later."""
EXCHANGED_SHARE, EXCHANGED_FRAMES = 0.1, 6
"""How often a view has the sides the other way round, and for how long."""
LATE_FRAMES: Final = 10.0
RATES_HZ: Final = (15.0, 25.0, 30.0)


class Trial(NamedTuple):
    """A rig that is known, and what it shows."""

    rig: Rig
    sighting: Sighting
    stature_m: float
    late_s: float


class Missed(NamedTuple):
    """How far a calibration is from the truth."""

    turn_deg: float
    """Of one camera against the other."""
    focal: float
    """The larger share by which a focal length is wrong."""
    late_frames: float
    place_m: float
    """Of camera 2 as camera 1 sees it."""


def trial(seed: int, posture: str = "", late_frames: float = LATE_FRAMES) -> Trial:
    """A made-up person before random cameras; another for each seed."""
    rng = np.random.default_rng([seed, 13])
    someone = person(seed)
    hz = float(rng.choice(RATES_HZ))
    motion = performance(someone, posture or ("free", *POSTURES)[seed % 16], seed, hz, 8.0)
    stature_m = someone.measures["stature_m"]
    rig = random_pair(rng, stature_m)
    late_s = float(rng.uniform(-late_frames, late_frames)) / hz
    return Trial(rig, filmed(motion, rig, late_s, rng), stature_m, late_s)


def random_pair(rng: np.random.Generator, stature_m: float) -> Rig:
    """Two cameras that see the middle of the room, whole persons in it."""
    apart = math.radians(rng.uniform(*APART_DEG)) * rng.choice([-1.0, 1.0])
    cameras = []
    for n, at in enumerate((0.0, apart)):
        focal = SIZE[0] * rng.uniform(*FOCALS)
        far = focal * stature_m / (rng.uniform(*FILLS) * SIZE[1])
        eye = np.array([far * math.sin(at), rng.uniform(*HEIGHTS_M), far * math.cos(at)])
        away = np.array([0.0, 0.55 * stature_m, 0.0]) + rng.normal(0, AIM_M, 3) - eye
        pitch = math.atan2(away[1], math.hypot(away[0], away[2]))
        R = rotation(math.atan2(-away[0], -away[2]), pitch, math.radians(rng.normal(0, ROLL_DEG)))
        K = ((focal, 0.0, SIZE[0] / 2), (0.0, focal, SIZE[1] / 2), (0.0, 0.0, 1.0))
        cameras.append(Camera(f"cam{n + 1}", K, as_matrix(R), as_row(-R @ eye)))
    return Rig(*SIZE, tuple(cameras))


def filmed(motion: Motion, rig: Rig, late_s: float, rng: np.random.Generator) -> Sighting:
    """What both views tell of a motion; what camera 2 shows bears a time that is late."""
    joints_m = motion.joints_m[motion.present][:, AT]
    times_s = np.arange(len(joints_m)) / motion.fps
    tracks = []
    for camera, shift in zip(rig.cameras, (0.0, late_s), strict=True):
        truth = _delayed(joints_m, times_s, shift)
        tracks.append(_seen(truth, times_s, camera, rng))
    return Sighting(tracks[0], tracks[1], (rig.width, rig.height))


def _delayed(joints_m: NDArray[np.float64], at_s: Vector, shift_s: float) -> NDArray[np.float64]:
    flat = joints_m.reshape(len(at_s), -1)
    columns = [np.interp(at_s - shift_s, at_s, column) for column in flat.T]
    return np.stack(columns, axis=1).reshape(joints_m.shape)


def _seen(
    joints_m: NDArray[np.float64], at_s: Vector, camera: Camera, rng: np.random.Generator
) -> JointTrack:
    """One view's landmarks: each as wrong as its confidence says, on average."""
    n = len(joints_m)
    exact = np.stack([project(camera, joints) for joints in joints_m])
    tall_px = np.median(np.ptp(exact[..., 1], axis=1)) / 0.95
    sure = np.clip(0.75 + _lasting((n, len(JOINT_NAMES)), rng) * 0.2, 0.05, 0.97)
    spread = 0.03 * tall_px / np.sqrt(-2 * np.log1p(-sure))
    noise = np.stack([_lasting(sure.shape, rng) for _ in range(2)], axis=-1)
    joints = exact + spread[..., None] * noise
    flipped = _stretches(n, rng)
    joints[flipped] = joints[flipped][:, OTHER_SIDE]
    across = (
        joints_m[:, JOINT_NAMES.index("l_shoulder")] - joints_m[:, JOINT_NAMES.index("r_shoulder")]
    )
    front = np.cross(across, [0.0, 1.0, 0.0])
    to = centre(camera) - joints_m[:, 0]
    turn = np.arctan2(front[:, 0], front[:, 2]) - np.arctan2(to[:, 0], to[:, 2])
    facing = np.degrees(turn) + 12 * _lasting((n,), rng) + 180 * flipped
    return JointTrack(at_s, joints, sure, (facing + 180) % 360 - 180, np.full(n, 0.9))


def _lasting(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.float64]:
    """Normal errors of variance 1 that last for some frames, along the first axis."""
    errors = rng.normal(size=shape)
    for n in range(1, shape[0]):
        errors[n] = LASTING * errors[n - 1] + math.sqrt(1 - LASTING**2) * errors[n]
    return errors


def _stretches(n: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    begun = rng.random(n) < EXCHANGED_SHARE / EXCHANGED_FRAMES
    return np.convolve(begun, np.ones(EXCHANGED_FRAMES))[:n] > 0


def missed(found: PersonCalibration, truth: Trial) -> Missed:
    """How far what was found is from what is true."""
    turns, places = [], []
    for rig in (found.rig, truth.rig):
        R_1, R_2 = (np.array(camera.R) for camera in rig.cameras)
        turns.append(R_2 @ R_1.T)
        places.append(R_1 @ (centre(rig.cameras[1]) - centre(rig.cameras[0])))
    cosine = (np.trace(turns[0] @ turns[1].T) - 1) / 2
    focals = [
        abs(one.K[0][0] / other.K[0][0] - 1)
        for one, other in zip(found.rig.cameras, truth.rig.cameras, strict=True)
    ]
    hz = 1 / float(np.median(np.diff(truth.sighting.first.times_s)))
    return Missed(
        math.degrees(math.acos(min(1.0, max(-1.0, cosine)))),
        max(focals),
        abs(found.late_s[0] - truth.late_s) * hz,
        float(np.linalg.norm(places[0] - places[1])),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    rows, good, told = [], 0, 0
    for seed in range(given.first, given.first + given.pairs):
        one = trial(seed)
        try:
            found = calibrated_by_person((one.sighting,), one.stature_m)
        except CalibrationError:
            told += 1
            continue
        off = missed(found, one)
        rows.append(off)
        good += off.turn_deg <= 3 and off.focal <= 0.05 and off.late_frames <= 0.5
    all_off = np.array(rows)
    print(f"{good} of {given.pairs} within 3 degrees, 5 % focal and 0.5 frames; {told} refused")
    for n, name in enumerate(Missed._fields):
        print(name, *(f"{p} %: {np.percentile(all_off[:, n], p):.3f}" for p in (50, 68, 90, 95)))


if __name__ == "__main__":
    main()
