"""Random pairs of cameras calibrated by made-up people: how many are found, and how honestly.

    .venv/bin/python benchmarks/wild_rigs.py --pairs 200

Geometry alone: joints are projected and spoiled as the network of landmarks spoils them, by errors
that last, and sides that are exchanged for a while.
"""

import argparse
import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.person.person_calibration import calibrated_by_person
from calibration.person.rig_quality import PersonCalibration
from calibration.tracks.joint_tracks import JointTrack, Sighting, Sightings
from calibration.tracks.rig_guess import PLACE, guess_of, rotation
from common.body.body import JOINT_NAMES, OTHER_SIDE, Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre, project
from common.rig.rig_file import CalibrationError
from synth.motion.motions import POSTURES, Motion, performance
from synth.person.people import Person, person
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
ASKED: Final = (3.0, 0.05, 0.5)
"""How far off a rig may be that is found: Missed, without the place."""
WALK_S: Final = 6.0
"""How long a walk lasts, after its opening posture."""
NEAREST_M: Final = 0.3
RATES_HZ: Final = (15.0, 25.0, 30.0)


class Film(NamedTuple):
    """What a person does before cameras."""

    joints_m: NDArray[np.float64]
    """(n, 15, 3)"""
    present: NDArray[np.bool_]
    """(n,)"""
    hz: float


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


def trial(seed: int, posture: str = "", late_frames: float = LATE_FRAMES, pieces: int = 0) -> Trial:
    """A made-up person before random cameras; another for each seed.

    Args:
        seed: Of rig, person and film.
        posture: One of POSTURES or "free", for 8 s; "": by the seed.
        late_frames: View 2 is late or early by as many at most.
        pieces: 0: that posture; else the film is of so many walks, see `walked`.
    """
    rng = np.random.default_rng([seed, 13])
    someone = person(seed)
    hz = float(rng.choice(RATES_HZ))
    stature_m = someone.measures["stature_m"]
    rig = random_pair(rng, stature_m)
    late_s = float(rng.uniform(-late_frames, late_frames)) / hz
    if pieces:
        return Trial(
            rig, seen(walked(someone, seed, hz, pieces), rig, late_s, rng), stature_m, late_s
        )
    motion = performance(someone, posture or ("free", *POSTURES)[seed % 16], seed, hz, 8.0)
    return Trial(rig, filmed(motion, rig, late_s, rng), stature_m, late_s)


def walked(someone: Person, seed: int, hz: float, pieces: int) -> Film:
    """Walks through the room's middle, each another way, and every fourth time some exercises.

    Between them nobody is seen for a second.
    """
    rng = np.random.default_rng([seed, 14])
    joints, present = [], []
    for n in range(pieces):
        name = ("walk_toward", "walk_slow_bigswing", "walk_toward", "free")[n % 4]
        motion = performance(someone, name, seed + 7919 * n, hz, WALK_S)
        turn = rotation(float(rng.uniform(-math.pi, math.pi)), 0.0, 0.0) * [[1], [-1], [-1]]
        there = motion.joints_m[motion.present][:, AT] @ turn.T
        away = round(hz)
        joints += [there, np.repeat(there[-1:], away, axis=0)]
        present += [np.ones(len(there), bool), np.zeros(away, bool)]
    return Film(np.concatenate(joints), np.concatenate(present), hz)


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
    return seen(Film(joints_m, np.ones(len(joints_m), bool), motion.fps), rig, late_s, rng)


def seen(film: Film, rig: Rig, late_s: float, rng: np.random.Generator) -> Sighting:
    """The same of a film; what is outside a picture is not seen."""
    return seen_by_all(film, rig, (0.0, late_s), rng).pair(0, 1)


def seen_by_all(
    film: Film, rig: Rig, late_s: Sequence[float], rng: np.random.Generator
) -> Sightings:
    """The same by any number of cameras, each with its own delay."""
    times_s = np.arange(len(film.joints_m)) / film.hz
    tracks = []
    for camera, shift in zip(rig.cameras, late_s, strict=True):
        truth = _delayed(film.joints_m, times_s, shift)
        track = _seen(truth, times_s, camera, rng)
        here = np.interp(times_s - shift, times_s, film.present) == 1.0
        inside = ((track.joints_px > 1) & (track.joints_px < np.array(SIZE) - 1)).all(axis=-1)
        ahead = (truth - centre(camera)) @ np.array(camera.R)[2] > NEAREST_M
        shown = inside & ahead & here[:, None]
        tracks.append(track._replace(confidence=np.where(shown, track.confidence, 0.0)))
    return Sightings(tuple(tracks), (rig.width, rig.height))


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
    tall_px = np.nanmedian(np.ptp(exact[..., 1], axis=1)) / 0.95
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
    joints = np.nan_to_num(joints)
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


def errors_of(found: PersonCalibration, truth: Trial) -> NDArray[np.float64]:
    """(n,) what is told of a rig with an error bar: how many bars it is off.

    Both focal lengths, each camera's height, pitch and roll, and the lateness.
    """
    off = [
        (found.quality.late_frames[0] - truth.late_s / _period_s(truth))
        / found.quality.late_error_frames[0]
    ]
    turned, true = (guess_of(rig) for rig in (found.rig, truth.rig))
    for n, camera in enumerate(found.quality.cameras):
        off.append((camera.focal_px - truth.rig.cameras[n].K[0][0]) / camera.focal_error_px)
        height = PLACE[f"height_{n + 1}"]
        off.append((turned[height] - true[height]) / camera.position_error_m[1])
        for name, error_deg in zip(("pitch", "roll"), camera.turn_error_deg[1:], strict=True):
            at = PLACE[f"{name}_{n + 1}"]
            off.append(math.degrees(turned[at] - true[at]) / error_deg)
    return np.array(off)


def _period_s(truth: Trial) -> float:
    return float(np.median(np.diff(truth.sighting.first.times_s)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--walks", type=int, default=0, help="film of so many; 0: one posture")
    given = parser.parse_args()
    rows, bars, told, refused = [], [], [], 0
    for seed in range(given.first, given.first + given.pairs):
        one = trial(seed, pieces=given.walks)
        try:
            found = calibrated_by_person((one.sighting,), one.stature_m)
        except CalibrationError:
            refused += 1
            continue
        rows.append(missed(found, one))
        bars.append(errors_of(found, one))
        told.append(bool(found.quality.unsure))
        print(seed, *(f"{value:.3f}" for value in rows[-1]), *found.quality.unsure, flush=True)
    all_off, unsure = np.array(rows), np.array(told)
    good = (all_off[:, :3] <= ASKED).all(axis=1)
    print(f"{good.sum()} of {given.pairs} within 3 degrees, 5 % focal and 0.5 frames")
    print(
        f"sure and right {(good & ~unsure).sum()}, unsure and right {(good & unsure).sum()}, "
        f"sure and wrong {(~good & ~unsure).sum()}, unsure and wrong {(~good & unsure).sum()}, "
        f"refused {refused}"
    )
    held = np.abs(np.array(bars)) < 1
    print(
        "bars hold", f"{held.mean():.2f}", "each", *(f"{share:.2f}" for share in held.mean(axis=0))
    )
    for n, name in enumerate(Missed._fields):
        print(name, *(f"{p} %: {np.percentile(all_off[:, n], p):.3f}" for p in (50, 68, 90, 95)))


if __name__ == "__main__":
    main()
