"""One viewer's thinking, frame by frame: the stages of section 3 in their order."""

from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, rest_pose
from common.body.proportions import body_vector, stature, thesis_bdp
from common.bus.message_codec import pack
from common.bus.messages import CameraFault, Facing, Guide, Measure, Pixel, Report, ViewerNumber
from common.config import Settings, proposes
from common.rig.camera import Camera
from viewer import camera_fault
from viewer.background.background import Background
from viewer.capture import CapturedFrame
from viewer.paper.arms import facade_arms, flank_arms
from viewer.paper.facing import thresholds_px, upper_body_px, vote
from viewer.paper.legs import facade_legs, flank_legs, squats
from viewer.paper.measure import measure_front, measure_side, refusal_of
from viewer.paper.posed_model import Figure, figure_of, rotation_of, view_at, yaw_of
from viewer.paper.position import located
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import Seen

FACADE_ANGLES = (
    "r_shoulder_y",
    "r_shoulder_z",
    "l_shoulder_y",
    "l_shoulder_z",
    "r_elbow_x",
    "l_elbow_x",
    "r_hip_z",
    "l_hip_z",
)
FOLLOWED = ("measuring", "tracking", "predicted")
"""Guides with these states say where the body is; otherwise it is looked for afresh."""

SQUAT_ANGLES = ("r_hip_x", "l_hip_x", "r_knee_x", "l_knee_x")
FLANK_ANGLES = ("r_shoulder_x", "l_shoulder_x", *SQUAT_ANGLES)


class State(NamedTuple):
    """What a viewer remembers between frames."""

    viewer: ViewerNumber
    rotation: NDArray[np.float64]
    """World to camera, (3, 3)."""
    settings: Settings
    lens: camera_fault.State
    silhouette: silhouette.State
    searches: bool
    """The pose is looked for here, angle by angle; otherwise the integrator reads it off the
    silhouettes, and this viewer cuts out and measures only."""
    vote: Facing
    squatting: bool = False


def init(
    viewer: ViewerNumber, background: Background, camera: Camera | None, settings: Settings
) -> State:
    """A viewer that has seen nothing but the empty room.

    Viewer 1 starts as the facade, viewer 2 as the flank (P47).
    """
    return State(
        viewer,
        rotation_of(camera, viewer),
        settings,
        camera_fault.init(background),
        silhouette.init(background, settings.silhouette),
        not proposes(settings, camera is not None),
        "facade" if viewer == 1 else "flank",
    )


def step(state: State, frame: CapturedFrame, guide: Guide | None) -> tuple[State, Report]:
    """One frame: silhouette, opening posture, facing, position, arms, legs (P23).

    A picture that shows no room (frozen, black, white) is told and not looked at.

    Args:
        state: What this viewer remembers.
        frame: The picture.
        guide: What the integrator made of the frame before; None at the start.
    """
    watched, fault = camera_fault.step(state.lens, frame.picture)
    state = state._replace(lens=watched)
    if fault:
        return state, _blind_report(state, frame, guide, fault)
    known = guide if _expected(guide, state.viewer) else None
    near = known.root_px[state.viewer - 1] if known is not None else None
    remembered, seen = silhouette.step(state.silhouette, frame.picture, near)
    state = state._replace(silhouette=remembered)
    report = _outline_report(state, frame, guide, seen)
    if seen.box is None:
        return state._replace(squatting=False), report
    facing = guide.facing[state.viewer - 1] if guide is not None else state.vote
    measure, refusal = _opening(seen, guide, facing)
    report = msgspec.structs.replace(report, measure=measure, refusal=refusal)
    if state.searches:
        return _searched(state, report, seen, guide, known)
    return state, msgspec.structs.replace(report, root_px=near or _middle_px(seen))


def _searched(
    state: State, report: Report, seen: Seen, guide: Guide | None, known: Guide | None
) -> tuple[State, Report]:
    """The report with what the search for the pose finds: facing, position, arms, legs."""
    facing = guide.facing[state.viewer - 1] if guide is not None else state.vote
    figure = _followed(state, seen, known) if known is not None else _found(state, seen, guide)
    state, width_px, limits_px = _facing(state, seen, figure, known)
    figure = located(figure)
    figure, squatting = _limbs(state, figure, known, facing)
    names = FACADE_ANGLES + SQUAT_ANGLES if facing == "facade" else FLANK_ANGLES
    report = msgspec.structs.replace(
        report,
        upper_body_px=width_px,
        vote=state.vote,
        thresholds_px=limits_px,
        root_px=(float(figure.view[14]), float(figure.view[15])),
        angles_deg={name: float(figure.pose[POSE_INDEX[name]]) for name in names},
        squatting=squatting,
        score=float(figure.score),
        matches=figure.matches,
    )
    return state._replace(squatting=squatting), report


def _expected(guide: Guide | None, viewer: ViewerNumber) -> bool:
    """Whether the integrator knows where in this view the body should be."""
    return (
        guide is not None
        and guide.status in FOLLOWED
        and guide.bdp is not None
        and guide.scale_px_per_m[viewer - 1] > 0.0
    )


def _outline_report(state: State, frame: CapturedFrame, guide: Guide | None, seen: Seen) -> Report:
    height, width = seen.mask.shape
    return Report(
        frame=frame.index,
        captured_s=frame.captured_s,
        clock_s=frame.clock_s,
        viewer=state.viewer,
        width=width,
        height=height,
        silhouette=pack(seen.mask),
        box=seen.box,
        area_px=seen.area_px,
        blobs=seen.blobs,
        cut=seen.cut,
        vote=state.vote,
        guide_frame=-1 if guide is None else guide.frames[state.viewer - 1],
        next_s=frame.next_s,
    )


def _blind_report(
    state: State, frame: CapturedFrame, guide: Guide | None, fault: CameraFault
) -> Report:
    """Nobody is seen, and why."""
    nobody = np.zeros(frame.picture.shape[:2], np.bool_)
    seen = Seen(nobody, box=None, area_px=0, blobs=0, cut=False)
    return msgspec.structs.replace(_outline_report(state, frame, guide, seen), fault=fault)


def _followed(state: State, seen: Seen, guide: Guide) -> Figure:
    """The model where and how the guide expects it."""
    assert guide.bdp is not None
    n = state.viewer - 1
    pose = np.array(guide.pose)
    pose[:3] = 0.0
    view = view_at(state.rotation, guide.scale_px_per_m[n], guide.root_px[n])
    return figure_of(seen.mask, body_vector(guide.bdp), pose, view)


def _found(state: State, seen: Seen, guide: Guide | None) -> Figure:
    """The model at rest, laid into the silhouette's box: nothing is known of its pose.

    The body is the guide's if one was known before, else the thesis's proportions (T4).
    """
    assert seen.box is not None
    bdp = thesis_bdp(1.0) if guide is None or guide.bdp is None else guide.bdp
    facing = state.vote if guide is None else guide.facing[state.viewer - 1]
    scale = (seen.box.bottom + 1 - seen.box.top) / stature(bdp)
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = yaw_of(facing, state.viewer)
    middle, _ = _middle_px(seen)
    legs_px = (bdp.r_upper_leg.height + bdp.r_lower_leg.height) * scale
    view = view_at(state.rotation, scale, (middle, seen.box.bottom + 1 - legs_px))
    return figure_of(seen.mask, body_vector(bdp), pose, view)


def _middle_px(seen: Seen) -> Pixel:
    """Mean column of a silhouette, and the middle of its rows."""
    assert seen.box is not None
    columns = np.arange(seen.mask.shape[1]) + 0.5
    middle = float(np.average(columns, weights=seen.mask.sum(axis=0)))
    return middle, (seen.box.top + seen.box.bottom + 1) / 2


def _opening(seen: Seen, guide: Guide | None, facing: Facing) -> tuple[Measure | None, str]:
    """What the opening posture tells, or why this is not it; nothing once measured."""
    assert seen.box is not None
    if guide is not None and guide.measured:
        return None, ""
    if seen.cut:
        return None, "the person is partly outside the picture"
    if facing == "flank":
        return measure_side(seen.mask, seen.box), ""
    refusal = refusal_of(seen.mask, seen.box)
    return (None, refusal) if refusal else (measure_front(seen.mask, seen.box), "")


def _facing(
    state: State, seen: Seen, figure: Figure, known: Guide | None
) -> tuple[State, float, tuple[float, float]]:
    """W_u-body and this view's vote; before a guide the start stands (P24-P26, P47)."""
    if known is None or known.bdp is None:
        return state, 0.0, (0.0, 0.0)
    scale = known.scale_px_per_m[state.viewer - 1]
    torso_px = known.bdp.torso.height * scale
    width_px = upper_body_px(seen.mask, float(figure.view[15]), torso_px)
    limits = thresholds_px(known.bdp, scale)
    held = vote(known.facing[state.viewer - 1], width_px, limits)
    return state._replace(vote=held), width_px, limits


def _limbs(
    state: State, figure: Figure, known: Guide | None, facing: Facing
) -> tuple[Figure, bool]:
    """Arms, then legs, as this facing sees them (P30-P35)."""
    settings, wide = state.settings.search, known is None
    if facing == "facade":
        figure = facade_arms(figure, settings, wide)
        squatting = False
        if known is not None and known.bdp is not None and known.measured:
            n = state.viewer - 1
            drop_m = (figure.view[15] - known.rest_row_px[n]) / known.scale_px_per_m[n]
            squatting = squats(state.squatting, float(drop_m) / stature(known.bdp))
        return facade_legs(figure, settings, squatting), squatting
    near = 0 if state.rotation[0] @ [0.0, 0.0, 1.0] > 0.0 else 1
    return flank_legs(flank_arms(figure, settings, near, wide), settings, near), False
