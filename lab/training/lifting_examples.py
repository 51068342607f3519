"""Training examples for the lifting network: joints as one or two cameras show them."""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre
from integrator.landmarks.landmark_rays import AT
from integrator.proposal.landmark_look import Shown, look
from integrator.proposal.lifting_network import aimed
from integrator.proposal.silhouette_window import Floats
from synth.motion.falling import fall, fallen, lain
from synth.motion.footing import Posed, posed
from synth.person.people import Person, person
from synth.person.skeleton import JOINTS as ALL_JOINTS
from synth.person.skeleton import turned
from synth.picture.random_rig import rig_about
from synth.picture.shown_joints import ShownJoints, shown_joints
from synth.picture.silhouette_examples import (
    AT_LARGE,
    DROP_SHARE,
    FPS,
    ORDINARY,
    PEOPLE,
    ROOM_M,
    course,
    differing,
)

PICK: Final = [ALL_JOINTS.index(name) for name in JOINT_NAMES]
AT_LARGE_SHARE, FALL_SHARE = 0.5, 0.15
"""Shares of the performances with free motion, and with falls."""
FALL_BEGINS_S: Final = (3.0, 12.0)
"""Time at which the excerpt of a fall begins."""
GAP_SHARE, GAP = 0.15, (5, 40)
"""For two cameras: share of performances in which one of them loses the person, and for how many
instants."""
BELIEVED, UNMEASURED, UNMEASURED_SHARE = 0.02, 0.05, 0.3
"""Relative deviation of a stature, of a measured and of an unmeasured person, and the share of
the unmeasured."""
FOCAL_WRONG, PITCH_WRONG_DEG = (0.01, 0.12), (0.3, 3.0)
"""Deviations of a camera's parameters: calibrated, and assumed."""
GUESSED_SHARE: Final = 0.25
"""Share of single cameras that are assumed."""
NEAREST_M: Final = 0.6
ASTRAY_M: Final = 1.5
"""Error of the middle, metres, beyond which an example is dropped."""
INSTANT_S: Final = 1.0 / FPS


class LiftingExample(NamedTuple):
    """An example from a performance before one camera or two."""

    inputs: Floats
    """(n, INPUTS)"""
    due: Floats
    """(n, 39) target output."""
    stature_m: float
    """Assumed stature."""


def lifting_examples(seed: int) -> list[LiftingExample]:
    """A performance seen by one camera and by two; each seed is one performance."""
    rng = np.random.default_rng([seed, 79])
    someone = differing(person(int(rng.integers(*PEOPLE))), rng)
    joints_m = _performed(someone, rng).joints_m[:, PICK]
    rig = rig_about(rng, joints_m[:, 0].mean(axis=0))
    made = (
        _seen(joints_m, rig, someone.measures["stature_m"], alone, rng) for alone in (True, False)
    )
    return [example for example in made if len(example.due)]


def _performed(someone: Person, rng: np.random.Generator) -> Posed:
    """Motion of a person, sometimes a fall."""
    angles = course(someone, AT_LARGE if rng.random() < AT_LARGE_SHARE else ORDINARY, rng)
    leash = np.tile(rng.uniform(-ROOM_M, ROOM_M, 2), (len(angles), 1))
    if rng.random() >= FALL_SHARE:
        return posed(someone.measures, angles, leash[0], leash)
    time_s = np.arange(len(angles)) / FPS + rng.uniform(*FALL_BEGINS_S)
    angles = lain(angles, np.tile(np.median(angles, axis=0), (len(angles), 1)), time_s)
    return fallen(posed(someone.measures, angles, leash[0], leash), fall(time_s, rng))


def _seen(
    joints_m: NDArray[np.float64],
    rig: Rig,
    stature_m: float,
    alone: bool,
    rng: np.random.Generator,
) -> LiftingExample:
    """Views of the first camera alone, or of both; none where the person comes too near."""
    cameras = rig.cameras[:1] if alone else rig.cameras
    believed_m = stature_m * (
        1.0 + rng.normal() * (UNMEASURED if rng.random() < UNMEASURED_SHARE else BELIEVED)
    )
    guessed = alone and bool(rng.random() < GUESSED_SHARE)
    inputs: list[Floats] = []
    due: list[NDArray[np.float64]] = []
    if all(_is_before(camera, joints_m) for camera in cameras):
        size = rig.width, rig.height
        views = [shown_joints(joints_m, camera, size, stature_m, rng) for camera in cameras]
        known = [_as_known(camera, guessed, rng) for camera in cameras]
        known_rig = Rig(*size, (known[0], known[-1]))
        for i, shown, since_s in _instants(views, rng):
            seen = look(shown, known_rig, believed_m, since_s)
            if seen is not None and np.linalg.norm(seen.middle_m - joints_m[i, 0]) < ASTRAY_M:
                inputs.append(seen.inputs)
                due.append(aimed(joints_m[i, AT], seen, believed_m))
    return LiftingExample(np.array(inputs, np.float32), np.array(due, np.float32), believed_m)


def _is_before(camera: Camera, joints_m: NDArray[np.float64]) -> bool:
    return bool((joints_m @ np.array(camera.R)[2] + camera.t[2]).min() >= NEAREST_M)


def _instants(
    views: list[ShownJoints], rng: np.random.Generator
) -> Iterator[tuple[int, tuple[Shown | None, Shown | None], float]]:
    """Number, both views, and the time since the instant before; some instants are missing."""
    n = len(views[0].confidence)
    gone = np.zeros((n, 2), np.bool_)
    if len(views) == 1:
        gone[:, 1] = True
    elif rng.random() < GAP_SHARE:
        start = int(rng.integers(n))
        gone[start : start + int(rng.integers(*GAP)), int(rng.integers(2))] = True
    since_s = INSTANT_S
    for i in range(n):
        if i and rng.random() < DROP_SHARE:
            since_s += INSTANT_S
            continue
        first, second = (
            None if away else Shown(*(part[i] for part in view))
            for view, away in zip((views[0], views[-1]), gone[i], strict=True)
        )
        yield i, (first, second), since_s
        since_s = INSTANT_S


def _as_known(camera: Camera, guessed: bool, rng: np.random.Generator) -> Camera:
    """A camera as its calibration states it, or as assumed."""
    times = float(np.exp(FOCAL_WRONG[guessed] * rng.normal()))
    R = turned("x", np.array([PITCH_WRONG_DEG[guessed] * rng.normal()]))[0] @ np.array(camera.R)
    (focal_px, _, x), (_, _, y), _ = camera.K
    K = ((times * focal_px, 0.0, x), (0.0, times * focal_px, y), (0.0, 0.0, 1.0))
    return Camera(camera.name, K, as_matrix(R), as_row(-R @ centre(camera)))
