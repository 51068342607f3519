"""All views of one person over time, as arrays."""

import math
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector
from common.body.observation import Landmarks
from common.bus.messages import View

JOINTS: Final = len(JOINT_NAMES)
_PELVIS, _NECK = (JOINT_NAMES.index(name) for name in ("pelvis", "neck"))
LEAST_SURE: Final = 0.4
"""Mean confidence of a view's landmarks below which a frame does not count."""
MOST_FRAMES, LONGEST = 80, 360
"""Number of moments used per clip, as neighbours err alike; and for a long clip."""
SEEN_AS_LONG: Final = 0.5
"""Share of the instants of the person seen longest that another needs for their evidence to
count."""
UPRIGHT: Final = math.cos(math.radians(60.0))
"""Cosine of the trunk's lean in the picture from which on a frame does not count for a rig: a
lying person has no soles on the floor, and is detected less well."""
ENOUGH_HZ: Final = 2.5
"""Moments a second that are used in a long clip."""


class JointTrack(NamedTuple):
    """One view's landmarks, frame after frame."""

    times_s: Vector
    """(n,) increasing."""
    joints_px: NDArray[np.float64]
    """(n, 15, 2)"""
    confidence: NDArray[np.float64]
    """(n, 15) in [0, 1]; 0 where no person is seen."""
    facing_deg: Vector
    """(n,) facing: 0 towards the camera, 90 to the right of its picture, degrees."""
    facing_confidence: Vector
    """(n,) confidence of the facing."""


class Sighting(NamedTuple):
    """Both views of one clip."""

    first: JointTrack
    second: JointTrack
    size_px: tuple[int, int]
    """Width and height of both pictures."""


class Sightings(NamedTuple):
    """All views of one clip, in the order of its cameras."""

    tracks: tuple[JointTrack, ...]
    size_px: tuple[int, int]
    """Width and height of all pictures."""

    def pair(self, one: int, other: int) -> Sighting:
        """Two of the views."""
        return Sighting(self.tracks[one], self.tracks[other], self.size_px)


def longest_seen(everyone: Iterable[Sightings]) -> tuple[Sightings, ...]:
    """The people whose evidence about a rig counts, who was seen longest first.

    Args:
        everyone: All views of each person; two or more.
    """
    each = sorted(everyone, key=_instants, reverse=True)
    least = SEEN_AS_LONG * max(map(_instants, each), default=0)
    return tuple(seen for seen in each if _instants(seen) >= least)


def _instants(seen: Sightings) -> int:
    """Number of a person's frames in the view that shows them most often but one: two judge."""
    shown = [int((track.confidence > 0.0).any(axis=1).sum()) for track in seen.tracks]
    return sorted(shown)[-2]


Row = tuple[float, Vector, Vector, float, float]
"""One frame: the fields of a JointTrack."""


def track_of(views: Iterable[View]) -> JointTrack:
    """The landmarks of one viewer's report; those cut off, not seen, or of a lying person have
    confidence 0."""
    return track_of_rows([row_of(view) for view in views])


def track_of_rows(rows: Sequence[Row]) -> JointTrack:
    """The same for stored observations."""
    times, joints, confidence, facing, sure = zip(*rows, strict=True) if rows else ([],) * 5
    return JointTrack(
        np.array(times, float),
        np.array(joints, float).reshape(-1, JOINTS, 2),
        np.array(confidence, float).reshape(-1, JOINTS),
        np.array(facing, float),
        np.array(sure, float),
    )


def row_of(view: View) -> Row:
    """The stored part of a view."""
    seen = None if view.person is None else view.person.landmarks
    if seen is None or not is_upright(seen):
        return view.captured_s, np.zeros((JOINTS, 2)), np.zeros(JOINTS), 0.0, 0.0
    joints, confidence = np.array(seen.joints_px), np.array(seen.confidence)
    outside = (joints < 1).any(axis=1) | (joints > (view.width - 1, view.height - 1)).any(axis=1)
    confidence[outside] = 0.0
    return view.captured_s, joints, confidence, seen.facing_deg, seen.facing_confidence


def is_upright(seen: Landmarks) -> bool:
    """Whether a view sees the trunk of a person who does not lie."""
    across, down = np.subtract(seen.joints_px[_PELVIS], seen.joints_px[_NECK]).tolist()
    return bool(down >= UPRIGHT * math.hypot(across, down))


def useful_times(sighting: Sighting, late_s: float) -> Vector:
    """(n,) moments of the first view at which both are sure of a person, evenly thinned.

    Args:
        sighting: Both views.
        late_s: Assumed delay of view 2.
    """
    sure = sighting.first.confidence.mean(axis=1) >= LEAST_SURE
    at = sighting.first.times_s
    if not len(at) or len(sighting.second.times_s) < 2:
        return np.empty(0)
    also = at_times(sighting.second, at + late_s).confidence.mean(axis=1) >= LEAST_SURE
    times = at[sure & also]
    lasts_s = float(np.ptp(times)) if len(times) else 0.0
    most = min(max(MOST_FRAMES, int(ENOUGH_HZ * lasts_s)), LONGEST, len(times))
    picked = np.unique(np.linspace(0, len(times) - 1, most).astype(int))
    kept: Vector = times[picked]
    return kept


def at_times(track: JointTrack, times_s: Vector) -> JointTrack:
    """The track between its frames, linearly; the lower of the two confidences is kept."""
    last = len(track.times_s) - 1
    after = np.clip(np.searchsorted(track.times_s, times_s), 1, max(last, 1))
    before = after - 1
    gap = track.times_s[after] - track.times_s[before]
    share = np.clip((times_s - track.times_s[before]) / gap, 0.0, 1.0)[:, None]
    confidence = np.minimum(
        np.where(share < 1.0, track.confidence[before], 1.0),
        np.where(share > 0.0, track.confidence[after], 1.0),
    )
    outside = (times_s < track.times_s[0] - gap) | (times_s > track.times_s[last] + gap)
    confidence[outside] = 0.0
    nearest = np.where(share[:, 0] < 0.5, before, after)
    way = share[..., None]
    joints = (1 - way) * track.joints_px[before] + way * track.joints_px[after]
    return JointTrack(
        times_s, joints, confidence, track.facing_deg[nearest], track.facing_confidence[nearest]
    )


def smoothed(track: JointTrack) -> JointTrack:
    """The track with each landmark smoothed over time, 1 : 2 : 1.

    Without smoothing a landmark between two frames has a smaller error than one at a frame, and
    views that are half a frame apart would seem to agree best.
    """
    weight = track.confidence[..., None]
    padded = np.pad(weight, ((1, 1), (0, 0), (0, 0)))
    joints = np.pad(track.joints_px * weight, ((1, 1), (0, 0), (0, 0)))
    total = 2 * padded[1:-1] + padded[:-2] + padded[2:]
    mean = (2 * joints[1:-1] + joints[:-2] + joints[2:]) / np.maximum(total, 1e-9)
    return track._replace(joints_px=np.where(weight > 0, mean, track.joints_px))


def height_px(track: JointTrack) -> float:
    """Typical height of the crown above the ankles, pixels; 0 where no person is seen."""
    ankles = [JOINT_NAMES.index("l_ankle"), JOINT_NAMES.index("r_ankle")]
    crown = track.joints_px[:, JOINT_NAMES.index("head_top")]
    tall = np.linalg.norm(crown - track.joints_px[:, ankles].mean(axis=1), axis=-1)
    seen = track.confidence.mean(axis=1) >= LEAST_SURE
    return float(np.percentile(tall[seen], 70)) if seen.any() else 0.0
