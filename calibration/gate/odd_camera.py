"""The one camera of several that stands turned against its calibration, by the people it sees."""

import math
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Final, NamedTuple

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from calibration.tracks.camera_clocks import Clocks
from calibration.tracks.joint_tracks import JointTrack, Sightings, at_times
from calibration.tracks.sight_lines import NARROW
from common.body.body import JOINT_NAMES
from common.rig.camera import Camera, Rig, arrays_of
from common.rig.turned_camera import turned

MIDDLES: Final = (
    ("neck", "neck"),
    ("head_top", "head_top"),
    ("pelvis", "pelvis"),
    *((f"l_{joint}", f"r_{joint}") for joint in ("shoulder", "hip", "knee", "ankle")),
)
"""Landmarks whose middles are compared: a view that exchanges left and right has them right."""
SURE: Final = 0.6
"""Confidence that both landmarks of a middle must have."""
PARTS: Final = 12
"""Number of parts of a clip: of each the median gap counts, as neighbouring frames err alike."""
FEWEST_SHARE: Final = 1 / 3
"""Share of a part's moments that both views must show."""
FEWEST_GAPS: Final = 6
"""Fewest such medians of a pair of views that count."""
USUAL_M: Final = 0.02
"""Median gap with a good rig, metres."""
USUAL_TURN: Final = math.radians(0.5)
"""Turn that costs as much as a part's gap of USUAL_M: what the sight lines tell little of, mostly
the roll, stays as calibrated. Chosen on turned cameras of rendered scenes."""
LEAST_M: Final = 0.03
"""Gap of a camera's sight lines, metres, up to which no camera is odd: with exact rigs it was 0.022
at most in rendered scenes of four cameras (docs/measurements.md)."""
AMONG: Final = 0.5
"""Share of that gap up to which it must fall, once the camera is turned, and up to which the gaps
among the other cameras must be: else the others are no better, or a turn is no cure."""

Pair = tuple[int, int]
Numbers = NDArray[np.float64]
Directions = Numbers
"""(V, n, J, 3) unit vectors in each camera's axes; NaN where it shows nothing."""


class OddCamera(NamedTuple):
    """A camera that contradicts all others as it is, and none of them once it is turned."""

    place: int
    """Its place in the rig, from 0."""
    turn: tuple[float, float, float]
    """Rotation vector of the scene in its axes, radians, from the calibration to where it looks."""
    apart_m: float
    """Gap between its sight lines and the others', metres."""
    then_m: float
    """The same once it is turned."""

    @property
    def turned_deg(self) -> float:
        """By how much it is turned."""
        return math.degrees(float(np.linalg.norm(self.turn)))


def report_of(camera: str, turned_deg: float, apart_mm: float, then_mm: float, since: str) -> str:
    """What a user is shown about a camera that was turned back.

    Args:
        camera: Its name.
        turned_deg: How far it looks beside its calibration.
        apart_mm: Gap between its sight lines and the others', as calibrated.
        then_mm: The same once it is turned.
        since: Where it is turned: "in this run".
    """
    return (
        f"{camera} looks {turned_deg:.1f} degrees beside its calibration: its sight lines pass "
        f"those of all other cameras by {apart_mm:.0f} mm, by {then_mm:.0f} mm once it is turned, "
        f"as it is {since}; calibrate again, or keep it as calibrated with --trust-calibration"
    )


def odd_camera(rig: Rig, everyone: Sequence[Sightings], clocks: Clocks) -> OddCamera | None:
    """The camera of three or more that is turned against the others; None: there is none.

    Sight lines of one camera that miss those of all others, which meet each other, are that
    camera's fault. Two cameras cannot tell whose it is. Lines are compared two by two: that shows
    no turn along the line between the cameras, but points of several lines err far more.

    Args:
        rig: All cameras.
        everyone: All views of each person, in the rig's order.
        clocks: Delays of the views after the first.
    """
    if len(rig.cameras) < 3:
        return None
    shown = [_directions(rig, seen, clocks) for seen in everyone]
    cameras = range(len(rig.cameras))
    gaps = {pair: _gaps_m(rig, shown, pair) for pair in combinations(cameras, 2)}
    known = {pair: own for pair, own in gaps.items() if np.isfinite(own).sum() >= FEWEST_GAPS}
    found = [_odd(rig, shown, known, place) for place in cameras]
    odd = [each for each in found if each is not None]
    return min(odd, key=lambda each: each.then_m, default=None)


def turned_back(rig: Rig, odd: OddCamera) -> Rig:
    """The rig with its odd camera turned to where it looks."""
    return _with_turn(rig, odd.place, np.array(odd.turn))


def _with_turn(rig: Rig, place: int, turn: Numbers) -> Rig:
    cameras = list(rig.cameras)
    cameras[place] = turned(cameras[place], np.asarray(cv2.Rodrigues(turn)[0], float))
    return msgspec.structs.replace(rig, cameras=tuple(cameras))


def _odd(
    rig: Rig, shown: Sequence[Directions], gaps: Mapping[Pair, Numbers], place: int
) -> OddCamera | None:
    """A camera with its turn; None where it is not odd."""
    own = [pair for pair in gaps if place in pair]
    others = [pair for pair in gaps if place not in pair]
    apart_m = _size_m([gaps[pair] for pair in own])
    if len(own) < 2 or not others or apart_m < LEAST_M:
        return None
    if _size_m([gaps[pair] for pair in others]) > AMONG * apart_m:
        return None
    turn = _turn(rig, shown, own, place)
    as_turned = _with_turn(rig, place, turn)
    then_m = _size_m([_gaps_m(as_turned, shown, pair) for pair in own])
    if then_m > AMONG * apart_m:
        return None
    across, down, ahead = turn.tolist()
    return OddCamera(place, (across, down, ahead), apart_m, then_m)


def _turn(rig: Rig, shown: Sequence[Directions], own: Sequence[Pair], place: int) -> Numbers:
    """The turn (3,) with which a camera's sight lines meet the others' best."""
    from scipy.optimize import least_squares  # a quarter of a second: for three cameras alone

    def misfits(turn: Numbers) -> Numbers:
        as_turned = _with_turn(rig, place, turn)
        gaps = [np.nan_to_num(_gaps_m(as_turned, shown, pair)) for pair in own]
        return np.concatenate([*gaps, turn * (USUAL_M / USUAL_TURN)]) / USUAL_M

    start = np.full(3, 1e-4)
    found = least_squares(misfits, start, loss="soft_l1", diff_step=1e-3, max_nfev=15)
    return np.asarray(found.x, float)


def _directions(rig: Rig, seen: Sightings, clocks: Clocks) -> Directions:
    """The middles of a person's landmarks, at the moments of the first view."""
    times_s = seen.tracks[0].times_s
    late_s = [0.0, *(clock.late_s if clock.is_found else 0.0 for clock in clocks)]
    views = zip(rig.cameras, seen.tracks, late_s, strict=False)
    return np.stack([_seen_by(camera, track, times_s + late) for camera, track, late in views])


def _seen_by(camera: Camera, track: JointTrack, times_s: Numbers) -> Directions:
    """(n, J, 3) directions in a camera's axes."""
    found = np.full((len(times_s), len(MIDDLES), 3), np.nan)
    if len(track.times_s) < 2 or not len(times_s):
        return found
    one, other = ([JOINT_NAMES.index(pair[side]) for pair in MIDDLES] for side in range(2))
    now = at_times(track, times_s)
    middles_px = (now.joints_px[:, one] + now.joints_px[:, other]) / 2
    sure = np.minimum(now.confidence[:, one], now.confidence[:, other]) >= SURE
    if sure.any():
        lens = np.array(camera.distortion) if any(camera.distortion) else None
        flat = cv2.undistortPoints(middles_px[sure][:, None], np.array(camera.K), lens)[:, 0]
        ahead = np.concatenate([flat, np.ones((len(flat), 1))], axis=1)
        found[sure] = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
    return found


def _gaps_m(rig: Rig, shown: Sequence[Directions], pair: Pair) -> Numbers:
    """Signed gaps between two views' sight lines, metres: the median of each part of the clip, by
    person and landmark; NaN where too few moments tell."""
    one, other = (arrays_of(rig.cameras[place]) for place in pair)
    found = [np.empty(0)]
    for of_person in shown:
        normal = np.cross(of_person[pair[0]] @ one.R, of_person[pair[1]] @ other.R)
        sine = np.linalg.norm(normal, axis=-1)
        gaps_m = normal @ (other.centre - one.centre) / np.maximum(sine, 1e-9)
        gaps_m[sine < math.sqrt(NARROW)] = np.nan
        found += [_median(part) for part in np.array_split(gaps_m, PARTS)]
    return np.concatenate(found)


def _median(part: Numbers) -> Numbers:
    """(J,) median of the gaps (n, J) of a part of the clip; NaN where too few moments tell."""
    found = np.full(part.shape[1], np.nan)
    enough = np.isfinite(part).sum(axis=0) >= max(1.0, FEWEST_SHARE * len(part))
    if enough.any():
        found[enough] = np.nanmedian(part[:, enough], axis=0)
    return found


def _size_m(gaps: Sequence[Numbers]) -> float:
    """Root mean square of the pairs' median gaps, metres."""
    each = [float(np.nanmedian(own**2)) for own in gaps if np.isfinite(own).any()]
    return math.sqrt(float(np.mean(each))) if each else 0.0
