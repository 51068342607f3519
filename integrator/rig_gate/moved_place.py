"""Where cameras that were moved stand now, by the person whom both views still see."""

import math
from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.body.body import Vector
from common.rig.camera import Camera, Rig, arrays_of, as_matrix, as_row
from common.bus.messages import ViewerNumber
from integrator.rig_gate.rig_fault import exchanged_rig
from integrator.rig_gate.rig_trust import case_of
from integrator.selfcalibration.joint_tracks import Sighting
from integrator.selfcalibration.rig_evidence import Known
from integrator.selfcalibration.rig_fit import fitted
from integrator.selfcalibration.rig_guess import BODY, LATE, PLACE, Pinhole, pinholes
from integrator.selfcalibration.rig_residuals import explained

PLACES: Final = {
    "yaw_2": math.radians(1.5),
    "pitch_2": math.radians(1.5),
    "roll_2": math.radians(1.5),
    "x_2": 0.15,
    "height_2": 0.1,
    "z_2": 0.15,
}
"""How far a camera stands from where its picture alone has it, as if turned on the spot; radians
and metres."""
TURNS: Final = ("pitch_1", "roll_1")
"""What is free of the first where both were moved: its place and yaw are the world's."""


class Placed(NamedTuple):
    """A rig in the world of the one before."""

    rig: Rig
    gap_mm: float
    """By how much sight lines of one joint miss each other, half of the time."""
    turn_error_deg: float
    """Of the moved camera's yaw, one sigma."""


def placed(
    rig: Rig, sighting: Sighting, moved: tuple[ViewerNumber, ...], late_s: float
) -> Placed | None:
    """The rig with its moved cameras where the person has them; None where too little is seen.

    Args:
        rig: With the moved cameras turned as their pictures tell.
        sighting: What both saw since.
        moved: One or both.
        late_s: How late view 2 is.
    """
    if moved == (1,):
        other = Sighting(sighting.second, sighting.first, sighting.size_px)
        found = placed(exchanged_rig(rig), other, (2,), -late_s)
        return None if found is None else found._replace(rig=exchanged_rig(found.rig))
    case = case_of(rig, sighting)
    if case is None:
        return None
    free = np.zeros(len(case.guess), np.bool_)
    free[[PLACE[name] for name in (*PLACES, *(TURNS if len(moved) == 2 else ()))]] = True
    free[BODY] = free[LATE] = True
    start = case.guess.copy()
    start[LATE] = late_s
    evidence = case.evidence._replace(known=_near(case.evidence.known, start))
    fit = fitted(start, evidence, free, 2, 12)
    one = explained(fit.guess, evidence, 0, fit.sides[0])
    covariance = np.linalg.pinv(fit.jacobian.T @ fit.jacobian)
    yaw = int(free[: PLACE["yaw_2"]].sum())
    return Placed(
        _in_world(rig, start, fit.guess),
        1e3 * float(np.median(np.abs(one.met.gap_m[one.used]))),
        math.degrees(math.sqrt(max(0.0, float(covariance[yaw, yaw])))),
    )


def _near(known: Known, start: Vector) -> Known:
    """What is believed: moved cameras stand near where their pictures have them."""
    mean, sigma = known.mean.copy(), known.sigma.copy()
    mean[LATE] = start[LATE]
    for name, spread in PLACES.items():
        sigma[PLACE[name]] = spread
    for name in TURNS:
        sigma[PLACE[name]] = PLACES["pitch_2"]
    return known._replace(mean=mean, sigma=sigma)


def _in_world(rig: Rig, start: Vector, guess: Vector) -> Rig:
    """The cameras of a guess in the world in which a rig has those of the guess before."""
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
    unchanged = np.allclose(guess[[PLACE[name] for name in TURNS]], start[[PLACE[n] for n in TURNS]])
    return msgspec.structs.replace(rig, cameras=(rig.cameras[0] if unchanged else kept, second))
