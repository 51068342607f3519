"""From both views of a person to a calibration, its quality and its error bars."""

import math
from typing import Final

import numpy as np

from calibration.person.independent_moments import measured_worth
from calibration.person.rig_certainty import (
    STEP,
    covariance_of,
    late_errors_frames,
    unsure_of,
)
from calibration.person.rig_evidence import Evidence, gathered, own_moments, sigma_px
from calibration.person.rig_fit import Fit, fitted, on_time, sides_of
from calibration.person.rig_quality import CameraQuality, PersonCalibration, Quality
from calibration.person.rig_residuals import Explained, explained, misfits
from calibration.person.rig_starts import known_of, level_starts, with_clocks
from calibration.person.world_axes import origin_of, published_rig
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import Sighting
from calibration.tracks.lateness import Clock, clock_of
from calibration.tracks.rig_guess import FOCALS, LATE, PLACE, RIG, pinholes
from common.body.body import Vector
from common.rig.camera import Rig, centre
from common.rig.rig_file import CalibrationError

FEWEST: Final = 12
"""Fewest moments in which both views must see the person."""
FEW, FEW_EACH = 24, 6
"""Number of moments used to choose the right start; the second number is per clip, with several
clips."""
STARTS: Final = 3
"""Number of the likeliest starts that are followed on each side, camera 2 to the right and to
the left of camera 1. All the likely ones of a walk may be mirror images (synthetic rigs, seeds
from 1000 on)."""
YAW: Final = PLACE["yaw_2"]
ELSEWHERE: Final = math.cos(math.radians(45.0))
"""Starts whose camera 2 ends within this angle, degrees, count as one: they would end alike."""
AT_FIRST: Final = 15
"""Number of moments used to place the person at first."""
NEAR, LEAST_MET = 3.0, 0.4
"""Residual, sigmas, within which sight lines meet, and the share of a clip's landmarks for which
they must. In synthetic rigs and people 0.89 and more do (seeds from 1000 on), in two videos of
different people 0.52 to 0.92, in independently wandering joints 0.11 at most (22 seeds)."""


def calibrated_by_person(
    sightings: tuple[Sighting, ...],
    stature_m: float,
    fov_deg: float | None = None,
    clocks: tuple[Clock, ...] | None = None,
) -> PersonCalibration:
    """Find both cameras from clips of one rig and one person.

    Args:
        sightings: Both views of each clip.
        stature_m: The person's stature: it gives the scale.
        fov_deg: Field of view of the cameras, where it is known.
        clocks: The clock of view 2 in each clip, where it is known.

    Raises:
        CalibrationError: When both views see too little of a person, or fit no rig.
    """
    clocks = clocks or tuple(clock_of(one) for one in sightings)
    known = with_clocks(
        known_of(sightings[0].size_px[0], stature_m, len(sightings), fov_deg), clocks
    )
    evidence = gathered(sightings, known)
    moments = evidence.moments
    if moments < FEWEST or not all(all(clip.units_px) for clip in evidence.clips):
        raise CalibrationError(
            f"both cameras see the same person in {moments} moments only: record a person, "
            f"whole in both pictures, who moves for some seconds"
        )
    found = best_fit(evidence, clocks)
    seen = _explained(found, evidence)
    if _met_share(seen, evidence) < LEAST_MET:
        raise CalibrationError(
            "what both cameras show of the person fits no rig: record a person who stands and "
            "walks, whole in both pictures"
        )
    places = seen[0].met.points_m[:AT_FIRST, prior.PELVIS]
    person_m = np.median(places, axis=0)
    rig = published_rig(found.guess, evidence.size_px, person_m)
    period_s = float(np.median(np.diff(sightings[0].second.times_s)))
    quality = _quality(found, evidence, rig, person_m, seen, period_s)
    return PersonCalibration(rig, tuple(found.guess[LATE:].tolist()), clocks, quality)


def best_fit(evidence: Evidence, clocks: tuple[Clock, ...]) -> Fit:
    """The best of all starts: first the cameras alone are fitted, then everything, then with all
    moments."""
    few = evidence.thinned(max(FEW, FEW_EACH * len(evidence.clips)))
    every = np.ones(len(evidence.known.mean), np.bool_)
    cameras = every & (np.arange(len(every)) < RIG)
    cameras[FOCALS] = False
    late_s = np.array([clock.late_s for clock in clocks])
    starts = level_starts(evidence, late_s)
    if not all(clock.is_found for clock in clocks):
        starts += level_starts(evidence, np.zeros(len(late_s)))
    starts.sort(key=lambda start: float((misfits(start, few, sides_of(start, few)) ** 2).sum()))
    rough = [fitted(start, few, cameras, 1, 8) for start in _of_both_sides(starts)]
    timed = [on_time(each.guess, few) for each in _unlike(rough)]
    better = [fitted(each, few, every, 2, 8) for each in timed]
    nearly = fitted(min(better, key=lambda each: each.cost).guess, evidence, every, 2, 12)
    timely = on_time(nearly.guess, evidence)
    by_time = sum(own_moments(clip) for clip in evidence.clips)
    freed = fitted(timely, evidence._replace(worth=by_time), every, 2, 12)
    worth = measured_worth(_explained(freed, evidence))
    return fitted(freed.guess, evidence._replace(worth=worth), every, 2, 12)


def _of_both_sides(starts: list[Vector]) -> list[Vector]:
    """The first few starts with camera 2 to the right of camera 1, and those with it to the
    left."""
    right = [start for start in starts if math.sin(start[YAW]) > 0.0]
    left = [start for start in starts if math.sin(start[YAW]) <= 0.0]
    return [*right[:STARTS], *left[:STARTS]]


def _unlike(rough: list[Fit]) -> list[Fit]:
    """The best fit, and the best one with camera 2 elsewhere, such as the mirror image."""
    best = min(rough, key=lambda each: each.cost)
    off = [math.cos(each.guess[YAW] - best.guess[YAW]) for each in rough]
    others = [one for one, near in zip(rough, off, strict=True) if near < ELSEWHERE]
    return [best, *sorted(others, key=lambda each: each.cost)[:1]]


def _met_share(seen: list[Explained], evidence: Evidence) -> float:
    """Of view 1's sure landmarks, the share whose sight lines meet in front of both cameras."""
    clips = zip(evidence.clips, seen, strict=True)
    shown = sum(np.isfinite(sigma_px(clip.first, clip.units_px[0])).sum() for clip, _ in clips)
    met = sum((one.used & one.met.before & (np.abs(one.met.gap) < NEAR)).sum() for one in seen)
    return float(met / max(shown, 1))


def _explained(found: Fit, evidence: Evidence) -> list[Explained]:
    return [explained(found.guess, evidence, n, sides) for n, sides in enumerate(found.sides)]


def _quality(
    found: Fit,
    evidence: Evidence,
    rig: Rig,
    person_m: Vector,
    seen: list[Explained],
    period_s: float,
) -> Quality:
    covariance = covariance_of(found)
    gaps_m = np.concatenate([np.abs(one.met.gap_m[one.used]) for one in seen])
    unit_px = np.mean([clip.units_px for clip in evidence.clips])
    late = found.guess[LATE:] / period_s
    late_error = late_errors_frames(covariance, period_s)
    return Quality(
        _cameras(found.guess, covariance, rig, person_m),
        evidence.known.stature_m,
        evidence.moments,
        1e3 * float(np.median(gaps_m)),
        float(np.median(gaps_m) / evidence.known.stature_m * unit_px),
        tuple(late.tolist()),
        tuple(late_error.tolist()),
        unsure_of(found, period_s),
    )


def _cameras(
    guess: Vector, covariance: Vector, rig: Rig, person_m: Vector
) -> tuple[CameraQuality, ...]:
    """Each camera as published, with its errors from the guess's covariance."""
    told = _told(guess, person_m)
    steps = STEP * np.eye(len(covariance))
    moved = np.stack([(_told(guess + step, person_m) - told) / STEP for step in steps])
    errors = np.sqrt(np.diag(moved.T @ covariance @ moved)).reshape(2, 7).tolist()
    return tuple(
        CameraQuality(
            camera.name,
            camera.K[0][0],
            error[0],
            tuple(centre(camera).tolist()),
            tuple(error[1:4]),
            tuple(error[4:]),
        )
        for camera, error in zip(rig.cameras, errors, strict=True)
    )


def _told(guess: Vector, person_m: Vector) -> Vector:
    """(14,) the published numbers of a rig: each camera's focal length, position and turn in
    degrees."""
    cameras = pinholes(guess)
    origin = origin_of(cameras, person_m)
    rows = []
    for camera, turn in zip(cameras, (np.array([0.0, *guess[2:4]]), guess[5:8]), strict=True):
        rows += [camera.focal_px, *(camera.centre_m - origin), *np.degrees(turn)]
    return np.array(rows)
