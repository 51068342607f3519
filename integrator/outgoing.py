"""Output of an instant: the body for all, the guide for the viewers' next frame."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from calibration.gate import silhouette_motion
from common.body.body import ANGLES_IN_POSE, JOINT_NAMES, Vector, rest_pose
from common.body.extremities import extremities
from common.body.kinematics import joints
from common.body.observation import Observation, Pixel
from common.body.proportions import body_vector, stature
from common.bus.instant import Instant, Seen
from common.bus.messages import Agreement, Body, Guide, Point, Status, Views
from common.npz_file import Facts
from common.rig.camera import project
from common.rig.upright_camera import as_filed
from integrator.belief import is_believed
from integrator.landmarks.extremity_sight import seen_extremities
from integrator.merge_state import State
from integrator.rig.body_position import pixels_of, scales_since
from integrator.rig.undistortion import undistorted_rig
from integrator.single.sight import Annotations

LOST_S: Final = 1.0 / 3.0
"""Duration without belief, seconds, after which the body is lost: five frames at 15 Hz. Until
then it is predicted: it has a pose, with confidence 0."""


def body_of(
    state: State, instant: Instant, seen: Seen, angles_deg: Vector, scores: tuple[float, ...]
) -> Body:
    """The body in its pose, with smoothed angles; a lost one has no pose.

    Args:
        state: Of this instant; its pose is unsmoothed.
        instant: The views received.
        seen: The same without distortion, for views with a person.
        angles_deg: The smoothed angles, ANGLE_NAMES order.
        scores: S of the pose in each view.
    """
    rig, found, bdp = state.rig, state.found, state.opening.bdp
    assert rig is not None
    assert found is not None
    assert bdp is not None
    pose = found.pose.copy()
    pose[list(ANGLES_IN_POSE)] = angles_deg
    places_m = _places_m(state, pose)
    pixels = tuple(project(camera, places_m) for camera in rig.cameras)
    outside = _outside(instant, pixels)
    told = state.agreement.told if sum(map(bool, seen)) > 1 else None
    believed = _believed(state, told)
    confidence = np.where(outside, 0.0, _confidence(state, scores) * believed)
    status, posed = _status(state), {}
    if status != "lost":
        posed = {
            "joints_m": _points(places_m),
            "joints_px": _filed(state, pixels),
            "pose": tuple(pose.tolist()),
            "angles_raw_deg": tuple(found.pose[list(ANGLES_IN_POSE)].tolist()),
            **_extremities(state, seen, places_m, believed),
        }
    return Body(
        **_moment(state, instant),
        **posed,
        status=status,
        views=_views(instant.detections),
        seen=tuple(person is not None for person in instant.detections),
        confidence=tuple(confidence.tolist()),
        score=scores,
        facing=found.facing,
        bdp=bdp,
        matches=sum(_matches(seen) for seen in instant.detections if seen is not None),
        lifting=None if found.alone is None else found.alone.lifting,
        scale_source=state.scale_source,
        calibration=state.calibration,
        agreement=told,
        moved=state.stands.doubtful,
        made_of=_made_of(instant),
    )


def weighed(
    state: State, instant: Instant, scores: tuple[float, ...], annotations: Annotations
) -> State:
    """The state with the duration of disbelief; a body lost in both views is forgotten.

    A frame in which the user placed joints is believed. Without forgetting, the network would
    continue from its memory of a wrong body. A single view keeps its memory, which alone
    distinguishes front from back. A body that was never believed is lost at once, as nothing shows
    that it is a person.
    """
    found = state.found
    assert found is not None
    assert state.rig is not None
    places_m = _places_m(state, found.pose)
    if annotations.joints_px or is_believed(places_m, state.rig, instant.detections, scores):
        return state._replace(doubted=0, ever_confirmed=True)
    lost = _lost_frames(state)
    least = lost if found.alone is not None and not state.ever_confirmed else 1
    state = state._replace(doubted=max(least, state.doubted + 1))
    if state.doubted % lost or found.alone is not None:
        return state
    return state._replace(found=found._replace(memory=None))


def _lost_frames(state: State) -> int:
    """Number of instants in a row without belief after which it is lost."""
    return max(1, round(LOST_S / state.smooth.period_s))


def _places_m(state: State, pose: Vector) -> NDArray[np.float64]:
    """The joints (15, 3) of the instant, in the world."""
    assert state.found is not None
    assert state.opening.bdp is not None
    if state.found.joints_m is not None:
        return state.found.joints_m
    return np.asarray(joints(body_vector(state.opening.bdp), pose))


def _extremities(state: State, seen: Seen, places_m: Vector, believed: float) -> Facts:
    """Nose, heels, toes and knuckles; confidence 0 where the rule alone places them."""
    assert state.rig is not None
    assert state.opening.bdp is not None
    stature_m = stature(state.opening.bdp)
    ends_m = extremities(places_m, stature_m)
    measured = np.zeros(len(ends_m))
    if not state.doubted:
        rig = undistorted_rig(state.rig)
        ends_m, measured = seen_extremities(ends_m, rig, seen, stature_m)
    return {
        "extremities_m": _points(ends_m),
        "extremities_px": _filed(state, [project(one, ends_m) for one in state.rig.cameras]),
        "extremities_confidence": tuple((measured * believed).tolist()),
    }


def _matches(seen: Observation) -> int:
    return sum(found.matches for found in (seen.search, seen.stick) if found is not None)


def _outside(instant: Instant, pixels: tuple[NDArray[np.float64], ...]) -> NDArray[np.bool_]:
    """Joints outside the only picture of a person, (15,): they are guessed."""
    seen = [(n, one) for n, one in enumerate(instant.detections) if one is not None]
    if len(seen) != 1 or not seen[0][1].cut:
        return np.zeros(len(JOINT_NAMES), np.bool_)
    ((own, person),) = seen
    places_px = pixels[own]
    shown = (places_px >= 0) & (places_px <= (person.width, person.height))
    return np.logical_not(shown.all(axis=1))


def _confidence(state: State, scores: tuple[float, ...]) -> Vector:
    """Confidence of each joint, (15,): found with the pose, or from the fit of the whole body."""
    assert state.found is not None
    if state.doubted:
        return np.zeros(len(JOINT_NAMES))
    if state.found.confidence is not None:
        return state.found.confidence
    return np.full(len(JOINT_NAMES), max(scores))


def _believed(state: State, told: Agreement | None) -> float:
    """Factor on the confidence where the rig is not believable."""
    if state.settings.trust_calibration:
        return 1.0
    return min(state.stands.left, 1.0 if told is None else told.believed)


def guide_of(state: State, instant: Instant, settled_now: bool) -> Guide:
    """Input of the viewers for their next frame.

    As printed each starts from its own estimate; beyond the print from both together.

    Args:
        state: Of this instant.
        instant: The views received.
        settled_now: The body has just been measured: both start from its place.
    """
    rig, found, known = state.rig, state.found, state.opening
    assert rig is not None
    assert found is not None
    place = found.pose[:3]
    measured_at = np.array(known.measured_at_m) if known.measured else place
    roots = list(pixels_of(rig, place))
    for n, seen in enumerate(instant.detections):
        own = not (state.method.shared_start or settled_now)
        if own and seen is not None and seen.search is not None:
            roots[n] = seen.search.root_px
    upright = pixels_of(rig, np.array([place[0], measured_at[1], place[2]]))
    return Guide(
        **_moment(state, instant),
        frames=state.frames,
        status=_status(state),
        bdp=known.bdp,
        measured=known.measured,
        facing=state.facing,
        scale_px_per_m=_or_unseen(scales_since(rig, place, measured_at)),
        root_px=tuple(roots),
        rest_row_px=tuple(row for _, row in upright),
        pose=tuple(found.pose.tolist()),
        stick=_asks_for_stick(state),
        proposes=state.proposes,
        moves=silhouette_motion.moves(state.motion),
    )


def _asks_for_stick(state: State) -> bool:
    """Whether the single remaining view shall fit a stick body to its next silhouette.

    On a calibrated rig the proposal is nearer than a lifted stick body, even where it fits badly:
    72 mm against 179 while camera 1 is lost (docs/measurements.md).
    """
    alone = None if state.found is None else state.found.alone
    return alone is not None and alone.stick and state.scale_source == "assumed"


def no_detection(state: State, instant: Instant) -> tuple[Body, Guide]:
    """The output while no person is in any view."""
    known, cameras = state.opening, len(instant.views)
    body = Body(
        **_moment(state, instant),
        status="empty",
        views="none",
        seen=(False,) * cameras,
        score=(0.0,) * cameras,
        facing=state.facing,
        bdp=known.bdp,
        scale_source=state.scale_source,
        calibration=state.calibration,
        moved=state.stands.doubtful,
        made_of=_made_of(instant),
    )
    guide = Guide(
        **_moment(state, instant),
        frames=state.frames,
        bdp=known.bdp,
        measured=known.measured,
        facing=state.facing,
        scale_px_per_m=(0.0,) * cameras,
        root_px=((0.0, 0.0),) * cameras,
        rest_row_px=(0.0,) * cameras,
        pose=tuple(rest_pose().tolist()),
        proposes=state.proposes,
        moves=(False,) * cameras,
    )
    return body, guide


def _moment(state: State, instant: Instant) -> Facts:
    """The frame of an instant, and its capture time."""
    newest = instant.newest
    return {"frame": state.number, "captured_s": newest.captured_s, "clock_s": newest.clock_s}


def _made_of(instant: Instant) -> tuple[int, ...]:
    """The frame of each viewer in an instant; -1: none."""
    return tuple(-1 if report is None else report.frame for report in instant.views)


def _status(state: State) -> Status:
    """The status, from presence, the opening posture and belief: never from S alone (M25).

    A person partly outside the only picture is tracked: the joints outside have confidence 0.
    """
    if state.doubted:
        return "lost" if state.doubted >= _lost_frames(state) else "predicted"
    return "measuring" if state.opening.under_way else "tracking"


def _views(seen: Seen) -> Views:
    """The views that show the person: of two cameras "both", of more their numbers."""
    numbers = [str(n) for n, person in enumerate(seen, start=1) if person is not None]
    if len(seen) == len(numbers) == 2:
        return "both"
    return "+".join(numbers) or "none"


def _or_unseen(scales: tuple[float, ...]) -> tuple[float, ...]:
    """Scales, with 0 for a camera that has the body behind it."""
    return tuple(scale if math.isfinite(scale) and scale > 0 else 0.0 for scale in scales)


def _points(places_m: Vector) -> tuple[Point, ...]:
    return tuple((x, y, z) for x, y, z in places_m.tolist())


def _filed(state: State, pixels: Sequence[NDArray[np.float64]]) -> tuple[tuple[Pixel, ...], ...]:
    """Places in each view, in its file's picture at the working size."""
    views = zip(pixels, state.uprights, strict=True)
    return tuple(_pixels(as_filed(own, upright)) for own, upright in views)


def _pixels(pixels: NDArray[np.float64]) -> tuple[Pixel, ...]:
    return tuple((u, v) for u, v in np.where(np.isnan(pixels), -1.0, pixels).tolist())
