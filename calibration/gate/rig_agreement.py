"""Agreement of both views under a rig, instant by instant, and the confidence that it leaves."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.joint_tracks import is_upright
from calibration.tracks.person_prior import ANKLE_SHARE
from common.body.body import JOINT_NAMES, OTHER_SIDE, Floats, Vector
from common.body.observation import Landmarks, Observation
from common.bus.instant import TwoSeen
from common.bus.messages import Agreement
from common.compiled import compiled
from common.rig.camera import Camera, Rig, arrays_of, rays

SAMPLES, APART_S = 40, 0.15
"""Number of instants that the agreement is computed from, and the seconds between two of them: the
last six seconds."""
FEWEST: Final = 8
"""Fewest samples that are judged."""
FEWEST_FACINGS: Final = 5
SURE: Final = 0.6
"""Mean confidence of a view's landmarks below which an instant does not count."""
SURE_FACING: Final = 0.85
USUAL_M: Final = 1.75
"""Stature, metres, from which the height of the ankles is taken: it differs among people by a
centimetre."""
NARROW: Final = 0.05
"""Squared sine of the angle between sight lines that are nearly parallel."""
STANDS: Final = 0.4
"""Quantile of the lower ankle's height that is taken for a foot on the floor."""
APART_MM: Final = (60.0, 80.0)
SOLES_MM: Final = ((-45.0, -75.0), (60.0, 95.0))
FACING_DEG: Final = (45.0, 75.0)
MOTION_MM: Final = (40.0, 60.0)
"""Difference between both views' motion of the joints, millimetres: the first is usual with a good
rig, the second occurs with no good rig; belief falls in between. Motions of one take differ by
30 mm at most, motions of different takes mostly by 60. The bounds above rest on the same clips:
with the right rig views lie 31 mm apart at most (56 mm for people that the network sees less
well), facings differ by 5 degrees, and soles are -29 to 4 mm high (high heels lift ankles by 5
cm more). Two pictures of one camera differ in facing by the angle between the rig's cameras.
Chosen on two performers and 16 synthetic people (docs/measurements.md)."""
SUDDEN: Final = 0.2
"""Factor on the belief where only the last second contradicts a rig."""
LEAST: Final = 0.05
"""Factor on the confidence for a rig that is not believed."""

SURE_JOINT: Final = 0.7
"""Confidence below which a joint does not count in the motion."""
FARTHEST_M: Final = 0.2
"""Distance at which gaps saturate: a joint that a view confuses with another says no more."""

_SHOULDERS, _KNEES, _ANKLES = (
    [n for n, name in enumerate(JOINT_NAMES) if name.endswith(part)]
    for part in ("shoulder", "knee", "ankle")
)
_MIDDLE: Final = [[n] for n, name in enumerate(JOINT_NAMES) if "_" not in name or "top" in name]
POINTS: Final = (*_MIDDLE, _SHOULDERS, _KNEES, _ANKLES)
"""Joints, and middles of pairs: the middles do not change where a view exchanges sides."""


class State(NamedTuple):
    """Observations of the last seconds."""

    samples: tuple[Vector, ...] = ()
    """One row per instant, metres: the gaps of POINTS, those of the joints (NaN where a view is
    not sure), and the lower ankle's height."""
    facings_deg: tuple[float, ...] = ()
    """Facing in view 1 minus facing in view 2, for each instant in which both were sure."""
    last_s: float = -math.inf
    """Time of the last row."""
    told: Agreement | None = None


def step(state: State, rig: Rig, seen: TwoSeen, now_s: float) -> State:
    """Process one instant.

    Args:
        state: Earlier observations by the same rig.
        rig: Two cameras without distortion.
        seen: The person in both views, without distortion.
        now_s: Time of the earlier of the two frames.
    """
    one, other = seen
    if one is None or other is None or not (_is_sure(one) and _is_sure(other)):
        return state
    if 0.0 <= now_s - state.last_s < APART_S:
        return state
    assert one.landmarks is not None
    assert other.landmarks is not None
    sample, turned = _sample(rig, one.landmarks, other.landmarks)
    samples = (*state.samples, sample)[-SAMPLES:]
    facings = (*state.facings_deg, *turned)[-SAMPLES:]
    told = agreement_of(np.array(samples), facings) if len(samples) >= FEWEST else None
    if told is not None and told.believed > SUDDEN:
        last = agreement_of(np.array(samples[-FEWEST:]), facings[-FEWEST:])
        if last.believed <= SUDDEN:  # older observations say nothing about the present
            samples, facings, told = samples[-FEWEST:], facings[-FEWEST:], last
    return State(samples, facings, now_s, told)


def agreement_of(samples: NDArray[np.float64], facings_deg: tuple[float, ...]) -> Agreement:
    """The agreement over instants (n, points + 15 + 1): places use the constant part of the
    gaps, motion the varying part."""
    apart_m = np.sqrt(np.mean(np.median(samples[:, : len(POINTS)], axis=0) ** 2))
    apart_mm = 1e3 * float(apart_m)
    motion_mm = 1e3 * motion_m(samples[:, len(POINTS) : -1], FEWEST)
    soles_mm = 1e3 * (float(np.quantile(samples[:, -1], STANDS)) - ANKLE_SHARE * USUAL_M)
    enough = len(facings_deg) >= FEWEST_FACINGS
    facing_deg = float(np.median(np.abs(facings_deg))) if enough else 0.0
    believed = min(
        _left(apart_mm, *APART_MM),
        _left(soles_mm, *SOLES_MM[1]),
        _left(-soles_mm, *(-limit for limit in SOLES_MM[0])),
        _left(facing_deg, *FACING_DEG),
        _left(motion_mm, *MOTION_MM),
    )
    return Agreement(apart_mm, soles_mm, facing_deg, motion_mm, believed)


def motion_m(gaps_m: NDArray[np.float64], fewest: int) -> float:
    """Difference between the views' motion of the joints, metres, from the gaps between sight
    lines.

    Args:
        gaps_m: (n, joints) signed; NaN where a view is not sure.
        fewest: Number of instants that must show a joint.

    Returns:
        Root mean square of each joint's gaps about their median, over the joints that enough
        instants show.
    """
    seen = gaps_m[:, np.isfinite(gaps_m).sum(axis=0) >= fewest]
    if not seen.size:
        return 0.0
    off_m = np.clip(seen - np.nanmedian(seen, axis=0), -FARTHEST_M, FARTHEST_M)
    return float(np.sqrt(np.mean(np.nanmean(off_m**2, axis=0))))


def _left(value: float, usual: float, never: float) -> float:
    """Factor on the confidence."""
    return float(np.interp(value, (usual, never), (1.0, LEAST)))


def _is_sure(person: Observation) -> bool:
    seen = person.landmarks
    if seen is None or person.cut or not is_upright(seen):
        return False
    return float(np.mean(seen.confidence)) >= SURE


def _sample(rig: Rig, first: Landmarks, second: Landmarks) -> tuple[Vector, tuple[float, ...]]:
    """(points + 15 + 1,) of an instant, and the facings' difference where both are sure."""
    cameras = rig.cameras
    gaps_m, places_m = meetings(cameras, _points(first), _points(second))
    lower_m = _lower_ankle_m(cameras, first, second)
    sample = np.array([*gaps_m, *joint_gaps_m(cameras, first, second, SURE_JOINT), lower_m])
    return sample, _turned(cameras, (first, second), places_m[0])


def _lower_ankle_m(cameras: tuple[Camera, ...], first: Landmarks, second: Landmarks) -> float:
    """Height of the lower ankle, with a view's sides exchanged where sight lines then meet
    better."""
    one, other = (np.array(each.joints_px)[_ANKLES] for each in (first, second))
    tried = [meetings(cameras, one, given) for given in (other, other[::-1])]
    _, places_m = min(tried, key=lambda met: float(np.abs(met[0]).sum()))
    return float(places_m[:, 1].min())


def meetings(
    cameras: tuple[Camera, ...], one_px: NDArray[np.float64], other_px: NDArray[np.float64]
) -> tuple[Vector, NDArray[np.float64]]:
    """Gaps (n,) between the sight lines of points (n, 2), and the points nearest to both."""
    first, second = (arrays_of(each) for each in cameras[:2])
    found: tuple[Vector, NDArray[np.float64]] = _met(
        first.centre, rays(cameras[0], one_px), second.centre, rays(cameras[1], other_px)
    )
    return found


@compiled
def _met(start: Vector, one: Floats, end: Vector, other: Floats) -> tuple[Vector, Floats]:
    """`meetings` of unit directions (n, 3) from two centres (3,)."""
    gaps_m, places_m, base = np.empty(len(one)), np.empty((len(one), 3)), end - start
    for n in range(len(one)):
        normal = np.cross(one[n], other[n])
        sine_2 = max((normal**2).sum(), NARROW)
        gaps_m[n] = (normal * base).sum() / math.sqrt(sine_2)
        cosine = (one[n] * other[n]).sum()
        far = ((one[n] * base).sum() - cosine * (other[n] * base).sum()) / sine_2
        places_m[n] = start + far * one[n] + 0.5 * gaps_m[n] / math.sqrt(sine_2) * normal
    return gaps_m, places_m


def _points(seen: Landmarks) -> NDArray[np.float64]:
    """(points, 2) px, of POINTS."""
    joints_px = np.array(seen.joints_px)
    return np.stack([joints_px[point].mean(axis=0) for point in POINTS])


def joint_gaps_m(
    cameras: tuple[Camera, ...], first: Landmarks, second: Landmarks, least: float
) -> Vector:
    """(15,) gaps between the joints' sight lines, with a view's sides exchanged where they then
    meet better; NaN where a view's confidence is below `least`."""
    one, other = (np.array(each.joints_px) for each in (first, second))
    tried = []
    for order in (slice(None), OTHER_SIDE):
        sure = np.minimum(first.confidence, np.array(second.confidence)[order]) >= least
        tried.append(np.where(sure, meetings(cameras, one, other[order])[0], np.nan))
    as_is, exchanged = tried
    both = np.isfinite(as_is) & np.isfinite(exchanged)
    is_better = np.abs(exchanged[both]).sum() < np.abs(as_is[both]).sum()
    return exchanged if is_better else as_is


def _turned(
    cameras: tuple[Camera, ...], seen: tuple[Landmarks, Landmarks], place_m: Vector
) -> tuple[float, ...]:
    """Facing in view 1 minus facing in view 2, degrees; () where unsure."""
    if min(each.facing_confidence for each in seen) <= SURE_FACING:
        return ()
    yaws = []
    for camera, each in zip(cameras, seen, strict=True):
        to = arrays_of(camera).centre - place_m
        yaws.append(math.degrees(math.atan2(to[0], to[2])) + each.facing_deg)
    return ((yaws[0] - yaws[1] + 180.0) % 360.0 - 180.0,)
