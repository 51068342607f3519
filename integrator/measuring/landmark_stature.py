"""The body's size by the person's landmarks: a body that they contradict for long is scaled."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from calibration.gate.rig_agreement import meetings
from calibration.tracks import person_prior as prior
from common.body.body import JOINT_NAMES, OTHER_SIDE
from common.body.observation import Landmarks
from common.body.proportions import stature
from common.bus.instant import TwoSeen
from common.rig.camera import Camera, Rig, arrays_of, rays
from integrator.measuring.known_body import Known, Measured
from integrator.measuring.prior_body import STATURES_M, USUAL_M

SURE: Final = 0.5
"""Confidence from which on a joint counts, in each view that shows it."""
MEETS_M: Final = 0.1
"""Gap between two sight lines of a joint, metres, up to which they show one place."""
FEWEST_SEGMENTS: Final = 3
"""Fewest segments of trunk and legs whose lengths are compared."""
LATEST, FEWEST = 30, 8
"""Number of instants whose median is the person's stature, at most and at least."""
AWAY: Final = 0.12
"""Logarithm of the ratio of that stature to the body's above which the body is scaled: it is 0.05
at most for four performers (docs/measurements.md)."""
DOWNWARD: Final = 0.05
"""Fall of a sight line, of its length, from which on it determines a place on the floor."""

_SEGMENTS: Final = np.flatnonzero(prior.UPRIGHT[prior.LENGTH_OF])
_HEAD: Final = JOINT_NAMES.index("head_top")


def step(body: Known, rig: Rig, seen: TwoSeen) -> Known:
    """The body after one instant, scaled where the landmarks of many contradict its size.

    The silhouettes of the first instant may be of something else. A body that the user gave stays.

    Args:
        body: The body so far.
        rig: Two cameras without distortion.
        seen: The person in both; one view alone shows a least stature.
    """
    if isinstance(body, Measured) and not body.measures:
        return body
    shown = [None if person is None else person.landmarks for person in seen]
    found_m = _stature_m(rig, shown, stature(body.bdp))
    if found_m is None:
        return body
    body = body._replace(statures_m=(*body.statures_m, found_m)[-LATEST:])
    typical_m = float(np.median(body.statures_m))
    scale = typical_m / stature(body.bdp)
    if len(body.statures_m) < FEWEST or abs(math.log(scale)) <= AWAY:
        return body
    return body._replace(bdp=body.bdp.scaled(scale), samples=(), unsampled=0)


def _stature_m(rig: Rig, shown: list[Landmarks | None], known_m: float) -> float | None:
    """Stature by an instant's landmarks, of a view alone the known one at least, as who crouches is
    not small; None where they show none."""
    first, second = shown
    found_m = None
    if first is not None and second is not None:
        found_m = by_segments_m(rig.cameras, first, second)
    if found_m is None:
        views = zip(shown, rig.cameras, strict=True)
        each_m = [by_floor_m(each, camera) for each, camera in views if each is not None]
        least_m = [each for each in each_m if each is not None]
        if len(least_m) != 1:  # two views contradict each other
            return None
        found_m = max(least_m[0], known_m)
    low, high = STATURES_M
    return found_m if low <= found_m <= high else None


def by_segments_m(cameras: tuple[Camera, ...], first: Landmarks, second: Landmarks) -> float | None:
    """Stature by the lengths of trunk, neck, thighs and shanks, whose sides a view may exchange;
    None where too few are sure."""
    one, other = (np.array(each.joints_px) for each in (first, second))
    tried = []
    for order in (slice(None), OTHER_SIDE):
        sure = np.minimum(first.confidence, np.array(second.confidence)[order]) >= SURE
        gaps_m, places_m = meetings(cameras, one, other[order])
        tried.append((np.where(sure, np.minimum(np.abs(gaps_m), MEETS_M), MEETS_M), places_m))
    gaps_m, places_m = min(tried, key=lambda each: float(each[0].sum()))
    near, far = prior.ENDS[_SEGMENTS].T
    met = (gaps_m[near] < MEETS_M) & (gaps_m[far] < MEETS_M)
    if met.sum() < FEWEST_SEGMENTS:
        return None
    long_m = np.linalg.norm(places_m[far] - places_m[near], axis=1)
    return float(np.median((long_m / prior.SHARES[prior.LENGTH_OF[_SEGMENTS]])[met]))


def by_floor_m(shown: Landmarks, camera: Camera) -> float | None:
    """Height of the crown of a person whose feet are on the floor, as one view shows it: the
    stature of who stands upright, and less otherwise; None where the view does not show it."""
    ends = [_HEAD, *prior.ANKLES]
    if np.array(shown.confidence)[ends].min() < SURE:
        return None
    joints_px = np.array(shown.joints_px)
    feet_px = joints_px[prior.ANKLES].mean(axis=0)
    (up, down), at = rays(camera, np.stack([joints_px[_HEAD], feet_px])), arrays_of(camera).centre
    if down[1] > -DOWNWARD:
        return None
    feet_m = at + down * (prior.ANKLE_SHARE * USUAL_M - at[1]) / down[1]
    return _height_over(feet_m, at, up)


def _height_over(
    feet_m: NDArray[np.float64], at_m: NDArray[np.float64], up: NDArray[np.float64]
) -> float | None:
    """Height at which a sight line passes the vertical above a place."""
    level = up[[0, 2]]
    far = float(level @ (feet_m - at_m)[[0, 2]]) / max(float(level @ level), 1e-9)
    return float(at_m[1] + far * up[1]) if far > 0.0 else None
