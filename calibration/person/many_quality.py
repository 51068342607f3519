"""Quality of a rig of any number of cameras found by the person."""

import math

import numpy as np

from calibration.person.many_fit import ManyFit, Pairs
from calibration.person.many_guess import EACH, Layout, Pair, pair_guess
from calibration.person.rig_certainty import STEP, late_errors_frames, unsure_words
from calibration.person.rig_quality import CameraQuality, Quality
from calibration.person.rig_residuals import Explained, explained
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector
from common.rig.camera import Rig, centre


def seen_by(layout: Layout, fit: ManyFit, pair: Pair, pairs: Pairs) -> list[Explained]:
    """Each clip by two of the cameras."""
    guess = pair_guess(layout, fit.guess, pair)
    return [explained(guess, pairs[pair], n, own) for n, own in enumerate(fit.sides[pair])]


def quality_of(layout: Layout, fit: ManyFit, pairs: Pairs, rig: Rig) -> Quality:
    """The error bars of a rig as published, and what is too uncertain.

    Args:
        layout: Of the vector.
        fit: The rig, with all its numbers free.
        pairs: The data of each pair.
        rig: The rig as published.
    """
    covariance = np.asarray(np.linalg.pinv(fit.jacobian.T @ fit.jacobian), np.float64)
    seen = [one for pair in pairs for one in seen_by(layout, fit, pair, pairs)]
    gaps_m = np.concatenate([np.abs(one.met.gap_m[one.used]) for one in seen])
    every = [*pairs.values()]
    period_s = float(np.median(np.diff(every[0].clips[0].second.times_s)))
    unit_px = np.mean([clip.units_px for evidence in every for clip in evidence.clips])
    stature_m, gap_m = every[0].known.stature_m, float(np.median(gaps_m))
    unsure, late_errors = _doubts(layout, fit.guess, covariance, period_s)
    return Quality(
        _cameras(covariance, rig),
        stature_m,
        max(evidence.moments for evidence in every),
        1e3 * gap_m,
        float(gap_m / stature_m * unit_px),
        tuple((layout.late(fit.guess)[:, 1:].ravel() / period_s).tolist()),
        late_errors,
        unsure,
    )


def _cameras(covariance: Numbers, rig: Rig) -> tuple[CameraQuality, ...]:
    """Each camera as published; the errors of places are against camera 1."""
    errors = np.sqrt(np.diag(covariance).clip(0.0))
    told = []
    for n, camera in enumerate(rig.cameras):
        focal, yaw, pitch, roll, x, height, z = errors[EACH * n : EACH * (n + 1)].tolist()
        turn_deg = (math.degrees(yaw), math.degrees(pitch), math.degrees(roll))
        x_m, y_m, z_m = centre(camera).tolist()
        focal_px = camera.K[0][0]
        own = (camera.name, focal_px, focal * focal_px, (x_m, y_m, z_m), (x, height, z), turn_deg)
        told.append(CameraQuality(*own))
    return tuple(told)


def _doubts(
    layout: Layout, guess: Vector, covariance: Numbers, period_s: float
) -> tuple[tuple[str, ...], tuple[float, ...]]:
    """The numbers that are too uncertain, by camera, and the standard deviations of the clocks."""
    words: list[str] = []
    errors = []
    for other in range(1, layout.cameras):
        own = pair_guess(layout, guess, (0, other))
        steps = np.array(
            [
                (pair_guess(layout, guess + STEP * unit, (0, other)) - own) / STEP
                for unit in np.eye(layout.size)
            ]
        )
        of_pair = steps.T @ covariance @ steps
        words += [f"camera {other + 1}: {word}" for word in unsure_words(own, of_pair, period_s)]
        errors.append(late_errors_frames(of_pair, period_s))
    return tuple(words), tuple(np.array(errors).T.ravel().tolist())
