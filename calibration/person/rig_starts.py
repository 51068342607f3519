"""Starts of the fit: level cameras around a person of known height."""

import math
from typing import Final

import numpy as np

from calibration.person.rig_evidence import Evidence, Known
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import at_times
from calibration.tracks.lateness import Clock
from calibration.tracks.rig_guess import BODY, LATE, PLACE, rotation
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector

FOCAL_SHARE: Final = 1.1
"""Focal length over picture width: a lens of 49 degrees; telephones see wider, room cameras
narrower."""
FOCAL_SPREAD: Final = 0.3
STATED_SPREAD: Final = 0.02
"""Standard deviation of the focal lengths' logarithm about that, and about a stated one."""
LEVEL_DEG: Final = {"pitch": 6.0, "roll": 2.5}
"""Standard deviation of the pitch and roll of cameras on stands."""
HEIGHT_M: Final = (1.2, 0.6)
LATE_S: Final = 0.1
FOUND_S: Final = 0.03
"""Standard deviation of a view's delay about 0, and about a clock that was found."""
YAWS_DEG: Final = tuple(range(-165, 180, 30))
MIDDLE_SHARE: Final = 0.65
"""Height of the middle between pelvis and neck, statures."""


def known_of(width_px: int, stature_m: float, clips: int, fov_deg: float | None = None) -> Known:
    """The prior on a rig before any observation.

    Args:
        width_px: Width of the pictures.
        stature_m: The person's stature.
        clips: Number of clips.
        fov_deg: Field of view of the cameras, where it is stated.
    """
    share = FOCAL_SHARE if fov_deg is None else 0.5 / math.tan(math.radians(fov_deg) / 2)
    focal = (math.log(share * width_px), FOCAL_SPREAD if fov_deg is None else STATED_SPREAD)
    mean = np.zeros(LATE + clips)
    sigma, soft = np.full(len(mean), np.inf), np.zeros(len(mean), bool)
    for n in ("1", "2"):
        mean[PLACE["log_focal_" + n]], sigma[PLACE["log_focal_" + n]] = focal
        mean[PLACE["height_" + n]], sigma[PLACE["height_" + n]] = HEIGHT_M
        for name, spread_deg in LEVEL_DEG.items():
            sigma[PLACE[f"{name}_{n}"]] = math.radians(spread_deg)
            soft[PLACE[f"{name}_{n}"]] = True
    mean[BODY], sigma[BODY] = np.log(prior.SHARES * stature_m), prior.SPREADS
    sigma[LATE:], soft[LATE:] = LATE_S, True
    return Known(mean, sigma, soft, stature_m)


def with_clocks(known: Known, clocks: tuple[Clock, ...]) -> Known:
    """The prior where the clocks of view 2 are known too."""
    mean, sigma = known.mean.copy(), known.sigma.copy()
    for n, clock in enumerate(clocks):
        if clock.is_found:
            mean[LATE + n], sigma[LATE + n] = clock.late_s, FOUND_S
    return known._replace(mean=mean, sigma=sigma)


def level_starts(evidence: Evidence, late_s: Vector) -> list[Vector]:
    """A guess for each yaw: cameras without pitch and roll, at about the right distance from the
    person.

    Args:
        evidence: The observations.
        late_s: Delay of view 2 in each clip.
    """
    clip, known = evidence.clips[0], evidence.known
    tracks = (clip.first, at_times(clip.second, clip.first.times_s + late_s[0]))
    places = []
    for n, track in enumerate(tracks):
        focal = math.exp(known.mean[n])
        middle = track.joints_px[:, [prior.PELVIS, prior.NECK]].mean(axis=1)
        flat = np.median(middle - np.array(evidence.size_px) / 2, axis=0) / focal
        places.append(focal * known.stature_m / clip.units_px[n] * np.array([*flat, 1.0]))
    return [_around(math.radians(yaw), places, known, late_s) for yaw in YAWS_DEG]


def _around(yaw: float, places: list[Numbers], known: Known, late_s: Vector) -> Vector:
    """Cameras that have the person at these places in their own axes, (3,) each, metres."""
    guess = known.mean.copy()
    one, other = (rotation(turn, 0.0, 0.0) for turn in (0.0, yaw))
    first_m, second_m = places[0] @ one, places[1] @ other
    height_m = MIDDLE_SHARE * known.stature_m - float(first_m[1])
    guess[PLACE["height_1"]] = height_m
    at = first_m - second_m + np.array([0.0, height_m, 0.0])
    guess[PLACE["yaw_2"]] = yaw
    for name, value in zip(("x_2", "height_2", "z_2"), at, strict=True):
        guess[PLACE[name]] = value
    guess[LATE:] = late_s
    return guess
