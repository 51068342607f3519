"""What is told of an instant: the body for everyone, the guide for the viewers' next frame."""

import math
from typing import Any

import numpy as np

from common.body.body import ANGLES_IN_POSE, JOINT_NAMES, Vector, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector
from common.bus.messages import Body, Guide, Pixel, Status, Views
from common.rig.camera import Rig, project
from integrator.merge_state import State
from integrator.pairing import Pair
from integrator.proposal import pose_proposal
from integrator.rig.body_position import pixels_of, scales_at, scales_since
from integrator.track_status import status_of


def body_of(
    state: State, rig: Rig, pair: Pair, angles_deg: Vector, scores: tuple[float, float]
) -> Body:
    """The body in the pose that is remembered, with its angles smooth.

    Args:
        state: Of this instant; its pose is as fused.
        rig: Two cameras.
        pair: What was heard of it.
        angles_deg: The smooth angles, ANGLE_NAMES order.
        scores: S of the pose in each view.
    """
    assert state.pose is not None
    assert state.opening.bdp is not None
    pose, in_pose = state.pose.copy(), list(ANGLES_IN_POSE)
    pose[in_pose] = angles_deg
    body = body_vector(state.opening.bdp)
    if state.beside_m is None:
        places = joints(body, pose)
    else:  # a memory has smoothed them: angles would only be late
        places = joints(body, state.pose)
        places += state.beside_m @ pose_proposal.trunk_axes(body, state.pose).T
    return Body(
        **_moment(state, pair),
        status=_status(state),
        views=_views(pair),
        joints_m=tuple((x, y, z) for x, y, z in places.tolist()),
        joints_px=tuple(_pixels(project(camera, places)) for camera in rig.cameras),
        pose=tuple(pose.tolist()),
        angles_raw_deg=tuple(state.pose[in_pose].tolist()),
        confidence=_confidence(state, scores),
        score=scores,
        facing=state.facing,
        bdp=state.opening.bdp,
        matches=sum(report.matches for report in pair if report is not None),
    )


def _confidence(state: State, scores: tuple[float, float]) -> tuple[float, ...]:
    """Of each landmark: what the proposal says of itself, as far as the pose is still its own, or
    how well the whole body fits."""
    if state.badly:
        return (0.0,) * len(JOINT_NAMES)
    if state.insight is not None:
        sure = state.insight.sure
        if state.matched:
            sure = pose_proposal.probability(sure, pose_proposal.SURENESS_OF_MATCHED)
        return tuple(sure.tolist())
    return (max(scores),) * len(JOINT_NAMES)


def guide_of(state: State, rig: Rig, pair: Pair, settled_now: bool) -> Guide:
    """What the viewers need for their next frame.

    As printed each starts where it had the body itself; in `default` where both together have it.

    Args:
        state: Of this instant.
        rig: Two cameras.
        pair: What was heard of it.
        settled_now: The body has just been measured: both start where it was.
    """
    assert state.pose is not None
    place, known = state.pose[:3], state.opening
    measured_at = np.array(known.measured_at_m) if known.measured else place
    roots = list(pixels_of(rig, place))
    for n, report in enumerate(pair):
        own = state.settings.mode == "paper" and not settled_now
        if own and report is not None and report.root_px is not None:
            roots[n] = report.root_px
    upright = pixels_of(rig, np.array([place[0], measured_at[1], place[2]]))
    return Guide(
        **_moment(state, pair),
        frames=state.frames,
        status=_status(state),
        bdp=known.bdp,
        measured=known.measured,
        facing=state.facing,
        scale_px_per_m=_or_unseen(scales_since(rig, place, measured_at)),
        reference_px_per_m=_or_unseen(scales_at(rig, measured_at)),
        root_px=(roots[0], roots[1]),
        rest_row_px=(upright[0][1], upright[1][1]),
        pose=tuple(state.pose.tolist()),
    )


def nobody(state: State, pair: Pair) -> tuple[Body, Guide]:
    """What is told while nobody is in any view."""
    known = state.opening
    body = Body(
        **_moment(state, pair), status="empty", views="none", facing=state.facing, bdp=known.bdp
    )
    guide = Guide(
        **_moment(state, pair),
        frames=state.frames,
        bdp=known.bdp,
        measured=known.measured,
        facing=state.facing,
        pose=tuple(rest_pose().tolist()),
    )
    return body, guide


def _moment(state: State, pair: Pair) -> dict[str, Any]:
    """Which frame is spoken of.

    Rows are counted by camera 1's frames, or by camera 2's where it is alone; -1 for an instant
    that camera 1 missed.
    """
    first, second = pair
    frame = -1 if first is None else first.frame
    if first is None and state.frames[0] < 0 and second is not None:
        frame = second.frame
    newest = pair.newest
    return {"frame": frame, "captured_s": newest.captured_s, "clock_s": newest.clock_s}


def _status(state: State) -> Status:
    """By presence, the opening and the fit together: never by S alone (M25)."""
    return status_of(state.badly, "measuring" if state.opening.under_way else "tracking")


def _views(pair: Pair) -> Views:
    names: dict[tuple[bool, bool], Views] = {(True, True): "both", (True, False): "1"}
    names |= {(False, True): "2", (False, False): "none"}
    first, second = pair.detections
    return names[first is not None, second is not None]


def _or_unseen(scales: tuple[float, float]) -> tuple[float, float]:
    """Scales with 0 for a camera that has the body behind it."""
    first, second = (scale if math.isfinite(scale) and scale > 0 else 0.0 for scale in scales)
    return first, second


def _pixels(pixels: Vector) -> tuple[Pixel, ...]:
    pixels[np.isnan(pixels)] = -1.0
    return tuple((u, v) for u, v in pixels.tolist())
