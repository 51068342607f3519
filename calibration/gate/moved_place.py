"""New poses of moved cameras, from the person whom both views still see."""

import math
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.gate.rig_fault import exchanged_rig
from calibration.gate.rig_trust import case_of, soles_m
from calibration.person.rig_evidence import Evidence, Known
from calibration.person.rig_fit import Fit, fitted, sides_of
from calibration.person.rig_residuals import explained, misfits
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import Sighting
from calibration.tracks.lateness import Clock
from calibration.tracks.rig_guess import BODY, LATE, PLACE, Pinhole, pinholes
from common.body.body import Vector
from common.bus.messages import ViewerNumber
from common.rig.camera import Camera, Rig, arrays_of, as_matrix, as_row

PLACES: Final = {
    "yaw_2": math.radians(3.0),
    "pitch_2": math.radians(3.0),
    "roll_2": math.radians(3.0),
    "x_2": 0.05,
    "height_2": 0.035,
    "z_2": 0.05,
}
"""Standard deviation of a moved camera's position and turn about the pure rotation that its
picture shows; radians and metres. With 0.15 m the landmarks pulled cameras that had only turned:
joints were 48 mm off instead of 22 (docs/measurements.md)."""
TURNS: Final = ("pitch_1", "roll_1")
"""Free numbers of camera 1 where both were moved: its position and yaw are the world's."""
WALL: Final = 1.5
"""Distance of the background, in distances of the person: before it, a step aside looks like a
turn."""
BACKDROP: Final = math.radians(0.3)
"""Standard deviation of the background's direction, radians."""
KNOWN_BODY: Final = 0.01
"""Standard deviation of the lengths that the person had before the move, as the landmarks
measure them."""


class Stood(NamedTuple):
    """Observations from before a camera was moved."""

    rig: Rig
    sighting: Sighting


class Person(NamedTuple):
    """A person as the landmarks measure them; their errors stay the same after the move."""

    lengths: Vector
    """(8,) logarithms of LENGTHS, metres."""
    soles_m: float
    """Measured height of their soles."""


class Placed(NamedTuple):
    """A rig in the world of the one before."""

    rig: Rig
    gap_mm: float
    """Median distance between the two sight lines of one joint."""
    turn_error_deg: float
    """Standard deviation of the moved camera's yaw."""


def placed(
    rig: Rig,
    sighting: Sighting,
    moved: tuple[ViewerNumber, ...],
    late_s: float,
    stood: Stood | None = None,
) -> Placed | None:
    """The rig with its moved cameras placed by the person; None where too little is seen.

    Args:
        rig: With the moved cameras turned as their pictures show.
        sighting: Both views since the move.
        moved: One camera or both.
        late_s: Delay of view 2.
        stood: Observations from before the move: they give the person's lengths by the valid rig.
    """
    if moved == (1,):
        other = None if stood is None else Stood(exchanged_rig(stood.rig), _other(stood.sighting))
        found = placed(exchanged_rig(rig), _other(sighting), (2,), -late_s, other)
        return None if found is None else found._replace(rig=exchanged_rig(found.rig))
    case = case_of(rig, sighting, Clock(late_s))
    if case is None:
        return None
    free = np.zeros(len(case.guess), np.bool_)
    free[[PLACE[name] for name in (*PLACES, *(TURNS if len(moved) == 2 else ()))]] = True
    free[BODY] = free[LATE] = True
    start = case.guess.copy()
    start[LATE] = late_s
    known = _near(case.evidence.known, start)
    person = None if stood is None else _person(stood, late_s)
    if person is not None:
        start, known = _of_person(person, start, known)
    evidence = case.evidence._replace(known=known)
    fit = _fitted(start, evidence, free)
    one = explained(fit.guess, evidence, 0, fit.sides[0])
    covariance = np.linalg.pinv(fit.jacobian.T @ fit.jacobian)
    yaw = int(free[: PLACE["yaw_2"]].sum())
    return Placed(
        _in_world(rig, start, fit.guess),
        1e3 * float(np.median(np.abs(one.met.gap_m[one.used]))),
        math.degrees(math.sqrt(max(0.0, float(covariance[yaw, yaw])))),
    )


def _other(sighting: Sighting) -> Sighting:
    return Sighting(sighting.second, sighting.first, sighting.size_px)


def _person(stood: Stood, late_s: float) -> Person | None:
    """The person as the landmarks measure them by the rig before."""
    case = case_of(stood.rig, stood.sighting, Clock(late_s))
    if case is None:
        return None
    free = np.zeros(len(case.guess), np.bool_)
    free[BODY] = True
    start = case.guess.copy()
    start[LATE] = late_s
    fit = fitted(start, case.evidence, free, 2, 8)
    one = explained(fit.guess, case.evidence, 0, fit.sides[0])
    return Person(fit.guess[BODY], soles_m(one, case.evidence.known.stature_m))


def _of_person(person: Person, start: Vector, known: Known) -> tuple[Vector, Known]:
    """Start and prior for a known person: the cameras are raised by the height error of the
    soles."""
    start, mean, sigma = start.copy(), known.mean.copy(), known.sigma.copy()
    for name in ("height_1", "height_2"):
        start[PLACE[name]] -= person.soles_m
        mean[PLACE[name]] -= person.soles_m
    start[BODY] = mean[BODY] = person.lengths
    sigma[BODY] = KNOWN_BODY
    stature_m = float(np.exp(person.lengths[prior.UPRIGHT]).sum()) / prior.CROWN_SHARE
    return start, known._replace(mean=mean, sigma=sigma, stature_m=stature_m)


def _fitted(start: Vector, evidence: Evidence, free: NDArray[np.bool_]) -> Fit:
    """The best guess near a start; the background keeps its place in the picture."""
    sides = sides_of(start, evidence)
    one = explained(start, evidence, 0, sides[0])
    camera = pinholes(start)[1]
    far_m = np.linalg.norm(one.met.points_m[:, prior.PELVIS] - camera.centre_m, axis=1)
    wall_m = WALL * float(np.median(far_m))
    found = start.copy()

    def misses(values: Vector) -> Vector:
        found[free] = values
        return np.concatenate(
            [misfits(found, evidence, sides), _backdrop(camera, pinholes(found)[1], wall_m)]
        )

    fit = least_squares(misses, start[free], x_scale="jac", max_nfev=20, ftol=1e-5, xtol=1e-6)
    found[free] = fit.x
    return Fit(found.copy(), float(fit.cost), sides, fit.jac)


def _backdrop(before: Pinhole, camera: Pinhole, wall_m: float) -> Vector:
    """(3,) displacement of a wall ahead from its place in the picture, in sigmas."""
    turn = camera.R @ before.R.T
    aside = before.R @ (camera.centre_m - before.centre_m)
    across = turn @ (np.array([0.0, 0.0, wall_m]) - aside)
    roll = math.atan2(float(turn[1, 0] - turn[0, 1]), float(turn[0, 0] + turn[1, 1]))
    return np.array([across[0] / across[2], across[1] / across[2], roll]) / BACKDROP


def _near(known: Known, start: Vector) -> Known:
    """The prior: moved cameras stand near the pose that their pictures show."""
    mean, sigma = known.mean.copy(), known.sigma.copy()
    mean[LATE] = start[LATE]
    for name, spread in PLACES.items():
        sigma[PLACE[name]] = spread
    for name in TURNS:
        sigma[PLACE[name]] = PLACES["pitch_2"]
    return known._replace(mean=mean, sigma=sigma)


def _in_world(rig: Rig, start: Vector, guess: Vector) -> Rig:
    """The cameras of a guess, in the world in which a rig holds those of the guess before."""
    old, first = pinholes(start)[0], arrays_of(rig.cameras[0])
    turn = old.R.T @ first.R
    shift_m = old.centre_m - turn @ first.centre

    def there(camera: Camera, found: Pinhole) -> Camera:
        R = found.R @ turn
        t = -R @ (turn.T @ (found.centre_m - shift_m))
        return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t))

    kept, second = (
        there(camera, found) for camera, found in zip(rig.cameras, pinholes(guess), strict=True)
    )
    turns = [PLACE[name] for name in TURNS]
    unchanged = np.allclose(guess[turns], start[turns])
    return msgspec.structs.replace(rig, cameras=(rig.cameras[0] if unchanged else kept, second))
