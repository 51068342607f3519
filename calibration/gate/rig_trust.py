"""Whether a rig is believable, judged by both views of the person alone."""

import math
from typing import Final, NamedTuple

import msgspec
import numpy as np

from calibration.gate.known_rig import as_ideal
from calibration.gate.rig_agreement import SURE_JOINT, motion_m
from calibration.person.rig_evidence import Evidence, Known, gathered
from calibration.person.rig_fit import Fit, fitted, sides_of
from calibration.person.rig_residuals import (
    Explained,
    explained,
    facing_off_deg,
)
from calibration.person.rig_starts import known_of, with_clocks
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import Sighting
from calibration.tracks.lateness import Clock, clock_of
from calibration.tracks.rig_guess import BODY, LATE, RIG, guess_of
from common.body.body import JOINT_NAMES, Vector
from common.rig.camera import Rig

STEADY: Final = [n for n, name in enumerate(JOINT_NAMES) if not name.endswith(("elbow", "wrist"))]
SURE: Final = 0.6
"""Confidence that a landmark must have in both views to be compared."""
FEWEST, ENOUGH = 12, 40
"""Fewest moments in which both views must see the person, and most that are used."""
MOST_APART_MM: Final = 65.0
"""Distance between the places that two views give a joint, millimetres, above which a rig is not
believed. With a good rig it is 28 mm at most for two performers, 52 mm for people that the
landmark network sees less well (docs/measurements.md)."""
FLOOR_MM: Final = (-35.0, 85.0)
"""Height of the soles with a good rig, millimetres, from ankles of bare feet: heels lift them by up
to 8 cm."""
STATURES_M: Final = (0.9, 2.3)
MOST_LATE_FRAMES: Final = 0.75
MOST_FACING_DEG: Final = 45.0
"""Difference of the views' facings, degrees, above which a rig is not believed: half of a
quarter turn, because two pictures of one camera differ by the angle between the rig's cameras.
With a good rig facings differ by 13 degrees at most (docs/measurements.md)."""
MOST_MOTION_MM: Final = 45.0
"""Difference between the views' motions, millimetres: 30 mm at most within one take, mostly 60
between different takes."""


class Trust(msgspec.Struct, frozen=True):
    """Assessment of two cameras and their clocks."""

    believed: bool
    apart_mm: float
    """Distance between the places that both views give the joints, varying errors left out."""
    apart_px: float
    late_frames: float
    """Delay of view 2, frames."""
    soles_mm: float
    """Median height of the lower foot's sole above the calibration's floor."""
    stature_m: float
    """The person's stature by the calibration's lengths."""
    facing_deg: float
    """Median difference between the views' headings of the person in the world."""
    motion_mm: float
    """Difference between the views' motions of the person, at the likeliest delay."""
    moments: int
    odd: tuple[str, ...] = ()
    """The unbelievable items: apart, late, floor, stature, facing, motion."""
    advice: str = ""
    """The likeliest cause and its cure; "" for a good rig."""


class Case(NamedTuple):
    """A rig and the observations that it is compared with."""

    guess: Vector
    evidence: Evidence
    clock: Clock


def case_of(rig: Rig, sighting: Sighting, clock: Clock | None = None) -> Case | None:
    """A rig and the person before it, with the stature by that rig; None where both views see too
    little of a person.

    Args:
        rig: Both cameras.
        sighting: Both views.
        clock: Clock of view 2, where it is known.
    """
    ideal, clock = as_ideal(sighting, rig), clock or clock_of(sighting)
    known = with_clocks(_held(guess_of(rig), known_of(rig.width, 1.75, 1)), (clock,))
    evidence = gathered((ideal,), known).thinned(ENOUGH)
    clip = evidence.clips[0]
    if len(clip.first.times_s) < FEWEST or not all(clip.units_px):
        return None
    guess = known.mean.copy()
    for _ in range(2):
        stature_m = _stature_m(explained(guess, evidence, 0, sides_of(guess, evidence)[0]))
        guess[BODY] = np.log(prior.SHARES * stature_m)
        mean = known.mean.copy()
        mean[BODY] = guess[BODY]
        evidence = evidence._replace(known=known._replace(mean=mean, stature_m=stature_m))
    return Case(guess, evidence, clock)


def _held(rig: Vector, known: Known) -> Known:
    """The prior where a rig is given: the rig itself."""
    mean, sigma, soft = known.mean.copy(), known.sigma.copy(), known.soft.copy()
    mean[:RIG] = rig
    sigma[:RIG] = (0.3, 0.3, 0.2, 0.2, 0.5, 0.3, 0.2, 0.2, 1.0, 0.5, 1.0)
    soft[:RIG] = False
    sigma[BODY] = 0.3
    return Known(mean, sigma, soft, known.stature_m, 0.3)


def _stature_m(one: Explained) -> float:
    """Stature by a rig: the sum of the lengths from ankle to crown."""
    near, far = prior.ENDS.T
    long_m = np.linalg.norm(one.met.points_m[:, far] - one.met.points_m[:, near], axis=-1)
    total = 0.0
    for length in np.flatnonzero(prior.UPRIGHT):
        seen = one.lengths_used & (length == prior.LENGTH_OF)
        share = float(prior.SHARES[length]) / prior.CROWN_SHARE
        total += float(np.median(long_m[seen])) if seen.any() else 1.75 * share
    return max(total / prior.CROWN_SHARE, 0.05)


def with_lateness(case: Case) -> Fit:
    """The rig with the delay of view 2 that fits best, near its clock where that is known; the
    rest is kept."""
    free = np.zeros(len(case.guess), np.bool_)
    free[LATE] = True
    fits = []
    for late_s in {0.0, case.clock.late_s} if case.clock.rivals_s else {case.clock.late_s}:
        start = case.guess.copy()
        start[LATE] = late_s
        fits.append(fitted(start, case.evidence, free, 2, 8))
    return min(fits, key=lambda fit: fit.cost)


def trust_of(
    rig: Rig, sighting: Sighting, period_s: float, clock: Clock | None = None
) -> Trust | None:
    """Assessment of a rig and its clocks; None where too little is seen.

    Args:
        rig: Both cameras.
        sighting: Both views.
        period_s: Time between frames.
        clock: Clock of view 2, where it is known.
    """
    case = case_of(rig, sighting, clock)
    if case is None:
        return None
    fit = with_lateness(case)
    one = explained(fit.guess, case.evidence, 0, fit.sides[0])
    stature_m = case.evidence.known.stature_m
    apart_m = apart(one, case.evidence)
    trust = Trust(
        True,
        1e3 * apart_m,
        apart_m / stature_m * float(np.mean(case.evidence.clips[0].units_px)),
        float(fit.guess[LATE]) / period_s,
        1e3 * soles_m(one, stature_m),
        stature_m,
        facing_off_deg(fit.guess, one, case.evidence.clips[0].first),
        1e3 * _motion_m(one, case.evidence),
        len(one.used),
    )
    odd = tuple(_odd(trust))
    return msgspec.structs.replace(trust, believed=not odd, odd=odd)


def apart(one: Explained, evidence: Evidence) -> float:
    """Distance between the views' places of the joints, metres.

    The median of each joint, signed, so that varying errors do not count; then the root mean square
    over the joints. Elbows and wrists are left out: a view that guesses them behind the body makes
    the same error for seconds.
    """
    sure = np.minimum(evidence.clips[0].first.confidence, one.second.confidence) >= SURE
    medians = [
        float(np.median(one.met.gap_m[used, joint]))
        for joint, used in enumerate((one.used & sure).T)
        if joint in STEADY and used.sum() >= FEWEST // 2
    ]
    return math.sqrt(float(np.mean(np.square(medians)))) if medians else 0.0


def _motion_m(one: Explained, evidence: Evidence) -> float:
    """Difference between the views' motions of the joints, metres."""
    sure = np.minimum(evidence.clips[0].first.confidence, one.second.confidence) >= SURE_JOINT
    return motion_m(np.where(one.used & sure, one.met.gap_m, np.nan), FEWEST // 2)


def soles_m(one: Explained, stature_m: float) -> float:
    """Median height of the lower foot's sole."""
    ankles = np.where(one.used[:, prior.ANKLES], one.met.points_m[:, prior.ANKLES, 1], np.inf).min(
        axis=1
    )
    seen = np.isfinite(ankles)
    return float(np.median(ankles[seen])) - prior.ANKLE_SHARE * stature_m if seen.any() else 0.0


def _odd(trust: Trust) -> list[str]:
    odd = {
        "apart": trust.apart_mm > MOST_APART_MM,
        "late": abs(trust.late_frames) > MOST_LATE_FRAMES,
        "floor": not FLOOR_MM[0] <= trust.soles_mm <= FLOOR_MM[1],
        "stature": not STATURES_M[0] <= trust.stature_m <= STATURES_M[1],
        "facing": trust.facing_deg > MOST_FACING_DEG,
        "motion": trust.motion_mm > MOST_MOTION_MM,
    }
    return [word for word, is_odd in odd.items() if is_odd]
