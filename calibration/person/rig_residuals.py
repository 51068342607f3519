"""Residuals of a rig against both views' observations, in sigmas: the objective of the fit."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.person.rig_evidence import (
    Evidence,
    Known,
    Sides,
    exchanged,
    sigma_px,
)
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import JointTrack, at_times
from calibration.tracks.rig_guess import BODY, FOCALS, LATE, PLACE, pinholes
from calibration.tracks.sight_lines import Meeting, Numbers, directions, meeting
from common.body.body import Vector

LENGTH_ERROR: Final = 0.012
"""Standard deviation of a segment's ends in the body, statures: landmarks are no bones."""
FACING_DEG: Final = 20.0
UNSURE_FACING, SURE_FACING = 0.6, 0.85
"""Confidence of a facing below which the network mistakes front and back for seconds."""
FEWEST_FACINGS: Final = 12
UPRIGHT_DEG, ALL_WAYS = 1.5, 0.15
"""Standard deviation of a standing person's lean, and its remainder where they have faced all
ways: a lean turns with the person (synthetic rigs, seeds from 1000 on)."""
TALL_SHARE: Final = 0.93
"""Distance of the neck from the ankles, as a share of its maximum, from which on a person stands
upright."""
FLOOR_M: Final = 0.02
ON_THE_RIGHT, SIDE_EDGE = 2.45, 0.2
"""Sigmas against a camera 2 to the right of camera 1, and the slope of that step. From far away,
mirror images differ in the facing alone. Where the facing is unsure the paper's rig decides,
which has camera 2 on the left (C1)."""
FOCALS_ALIKE: Final = 0.3
"""Standard deviation of the logarithm of both focal lengths' ratio."""
FLOOR_FRAMES, FACING_FRAMES = 6.0, 8.0
"""Number of independent moments that all lowest feet, and all facings, of a clip count for."""
UNSEEN: Final = 1.0
"""Residual, sigmas, of what one view does not show: a clock must not win because less is seen."""
BEHIND: Final = 10.0
"""Residual, sigmas, of a landmark behind a camera."""


class Explained(NamedTuple):
    """One clip under a rig."""

    met: Meeting
    """(n, 15) joints that both views show, triangulated."""
    used: NDArray[np.bool_]
    """(n, 15) which of them count."""
    lengths: Numbers
    """(n, 12) residuals of the segments, sigmas."""
    lengths_used: NDArray[np.bool_]
    second: JointTrack
    """View 2 at the same times, sides exchanged."""


def softened(residual: Numbers) -> Numbers:
    """Residuals whose squares are Cauchy's loss: an outlier's influence is bounded."""
    soft: Numbers = np.sign(residual) * np.sqrt(2.0 * np.log1p(residual**2 / 2.0))
    return soft


def misfits(guess: Vector, evidence: Evidence, sides: tuple[Sides, ...]) -> Vector:
    """All residuals: the priors, and each clip's observations."""
    rows = prior_misfits(guess, evidence.known) + observed_misfits(guess, evidence, sides)
    return np.concatenate(rows)


def observed_misfits(guess: Vector, evidence: Evidence, sides: tuple[Sides, ...]) -> list[Vector]:
    """Residuals of each clip's observations."""
    rows: list[Vector] = []
    for n, clip in enumerate(evidence.clips):
        one = explained(guess, evidence, n, sides[n])
        rows += data_misfits(one, evidence.own_share)
        rows += standing_misfits(one, evidence.known.stature_m)
        rows.append(facing_misfits(guess, one, clip.first))
    return rows


def explained(guess: Vector, evidence: Evidence, number: int, sides: Sides) -> Explained:
    """The points and the segments' residuals of one clip."""
    clip = evidence.clips[number]
    cameras, middle_px = pinholes(guess), np.array(evidence.size_px) / 2
    times_s = clip.first.times_s + float(guess[LATE + number])
    second = exchanged(at_times(clip.second, times_s), sides)
    rays = (
        directions(cameras[0], middle_px, clip.first.joints_px),
        directions(cameras[1], middle_px, second.joints_px),
    )
    sigmas = (sigma_px(clip.first, clip.units_px[0]), sigma_px(second, clip.units_px[1]))
    used = np.isfinite(sigmas[0]) & np.isfinite(sigmas[1])
    met = meeting(cameras, rays, (np.where(used, sigmas[0], 1.0), np.where(used, sigmas[1], 1.0)))
    near, far = prior.ENDS.T
    both = (used & met.before)[:, near] & (used & met.before)[:, far]
    return Explained(met, used, _length_misfits(met, np.exp(guess[BODY])), both, second)


def _length_misfits(met: Meeting, lengths_m: Vector) -> Numbers:
    """(n, 12) sigmas."""
    near, far = (met.of_joints(ends) for ends in prior.ENDS.T)
    along = far.points_m - near.points_m
    long_m = np.maximum(np.sqrt((along**2).sum(axis=-1)), 1e-6)
    unit = along / long_m[..., None]
    variance = near.variance_m2(unit) + far.variance_m2(unit)
    own_m = LENGTH_ERROR / prior.CROWN_SHARE * float(lengths_m[prior.UPRIGHT].sum())
    misfit: Numbers = (long_m - lengths_m[prior.LENGTH_OF]) / np.sqrt(variance + own_m**2)
    return misfit


def data_misfits(one: Explained, own: float) -> list[Vector]:
    """Residuals of landmarks: sight lines that miss each other, segments of another length.

    Args:
        one: A clip under a rig.
        own: Share of the landmarks whose errors are independent.
    """
    gaps = np.where(one.met.before, one.met.gap, BEHIND)
    share = math.sqrt(own)
    return [
        share * softened(np.where(one.used, gaps, UNSEEN)).ravel(),
        share * softened(np.where(one.lengths_used, one.lengths, UNSEEN)).ravel(),
    ]


def standing_misfits(one: Explained, stature_m: float) -> list[Vector]:
    """Residuals of the floor under the lower foot, and of the vertical along an upright person."""
    points, used = one.met.points_m, one.used & one.met.before
    height = np.where(used[:, prior.ANKLES], points[:, prior.ANKLES, 1], np.inf).min(axis=1)
    seen = np.isfinite(height)
    above = np.where(seen, height - prior.ANKLE_SHARE * stature_m, 0.0)
    few = math.sqrt(FLOOR_FRAMES / max(float(seen.sum()), FLOOR_FRAMES))
    axis = points[:, prior.NECK] - points[:, prior.ANKLES].mean(axis=1)
    tall = np.sqrt((axis**2).sum(axis=-1))
    stands = used[:, prior.ANKLES].all(axis=1) & used[:, prior.NECK]
    lean = np.zeros(2)
    if stands.any():
        stands &= tall >= TALL_SHARE * np.percentile(tall[stands], 80)
        lean = np.degrees(np.median(axis[stands] / tall[stands, None], axis=0)[[0, 2]])
    lean_deg = UPRIGHT_DEG * min(1.0, math.hypot(_one_way(points, used), ALL_WAYS))
    return [few * softened(above / FLOOR_M), lean / lean_deg]


def _one_way(points_m: Numbers, used: NDArray[np.bool_]) -> float:
    """How constantly the person (n, 15, 3) faces one way, in [0, 1]."""
    seen = used[:, prior.SHOULDERS].all(axis=1)
    if not seen.any():
        return 1.0
    left, right = points_m[seen][:, prior.SHOULDERS].swapaxes(0, 1)
    across = (left - right)[:, [0, 2]]
    long_m = np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-6)
    return float(np.linalg.norm((across / long_m).mean(axis=0)))


def facing_misfits(guess: Vector, one: Explained, first: JointTrack) -> Vector:
    """(n,) difference between the views' headings of the person."""
    turned, sure = _turned(guess, one, first)
    sure = np.clip((sure - UNSURE_FACING) / (SURE_FACING - UNSURE_FACING), 0.0, 1.0) ** 2
    off = 2.0 * np.sin(turned / 2.0) / math.radians(FACING_DEG)
    few = FACING_FRAMES / max(len(sure), FACING_FRAMES)
    misfit: Vector = np.sqrt(few * sure) * softened(off)
    return misfit


def facing_off_deg(guess: Vector, one: Explained, first: JointTrack) -> float:
    """Their median in degrees, in [0, 180]; 0 where views are seldom sure."""
    turned, sure = _turned(guess, one, first)
    off = np.degrees(np.abs(np.angle(np.exp(1j * turned[sure > SURE_FACING]))))
    return float(np.median(off)) if len(off) >= FEWEST_FACINGS else 0.0


def _turned(guess: Vector, one: Explained, first: JointTrack) -> tuple[Vector, Vector]:
    """(n,) facing in view 1 minus facing in view 2, and the confidence of both."""
    place = one.met.points_m[:, prior.PELVIS]
    turned = np.zeros(len(place))
    for sign, camera, track in zip((1, -1), pinholes(guess), (first, one.second), strict=True):
        to = camera.centre_m - place
        turned += sign * (np.arctan2(to[:, 0], to[:, 2]) + np.radians(track.facing_deg))
    return turned, np.minimum(first.facing_confidence, one.second.facing_confidence)


def prior_misfits(guess: Vector, known: Known) -> list[Vector]:
    """Residuals of the priors on rig and person."""
    believed = np.isfinite(known.sigma)
    off = (guess[believed] - known.mean[believed]) / known.sigma[believed]
    focals = (guess - known.mean)[FOCALS]
    alike = float(focals[0] - focals[1]) / FOCALS_ALIKE
    high_m = float(np.exp(guess[BODY])[prior.UPRIGHT].sum())
    stature = math.log(high_m / (prior.CROWN_SHARE * known.stature_m)) / known.stature_error
    soft = softened(np.array([*off[known.soft[believed]], alike]))
    right = 0.5 + 0.5 * math.tanh(math.sin(guess[PLACE["yaw_2"]]) / SIDE_EDGE)
    return [off[~known.soft[believed]], soft, np.array([stature, ON_THE_RIGHT * right])]
