"""One viewer's thinking, frame by frame: the stages of section 3 in their order."""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, rest_pose
from common.body.proportions import body_vector, stature, thesis_bdp
from common.bus.message_codec import pack
from common.bus.messages import Box, Facing, Guide, Measure, Pixel, Report, ViewerNumber
from common.config import Settings
from common.method import Method
from common.raster.kernel import CENTRE_X, CENTRE_Y
from common.raster.similarity import Mask
from common.rig.camera import Camera
from viewer import camera_fault
from viewer.background.background import Background
from viewer.background.moved_objects import Patch
from viewer.capture import CapturedFrame
from viewer.paper.arms import facade_arms, flank_arms
from viewer.paper.facing import thresholds_px, upper_body_px, vote
from viewer.paper.legs import facade_legs, flank_legs, squats
from viewer.paper.measure import measure_front, measure_side, refusal_of
from viewer.paper.posed_model import Figure, figure_of, rotation_of, view_at, yaw_of
from viewer.paper.position import located
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import Seen
from viewer.stick import stick_fit
from viewer.stick.standing_height import Standing

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
    method: Method
    alone: bool
    """It is the only viewer of its run."""
    fault: camera_fault.State
    silhouette: silhouette.State
    coming: tuple[Patch, ...]
    """What of the background is to change, in the order of time."""
    searches: bool
    """The pose is looked for here, angle by angle; otherwise the integrator reads it off the
    silhouettes, and this viewer cuts out and measures only."""
    vote: Facing
    standing: Standing | None
    """How tall the person stands; None: not known before."""
    squatting: bool = False
    near_px: Pixel | None = None
    """The middle of the last silhouette, where no guide tells where the body is expected."""


def init(
    viewer: ViewerNumber,
    background: Background,
    camera: Camera | None,
    settings: Settings,
    method: Method,
    *,
    alone: bool = False,
    patches: Sequence[Patch] = (),
    standing: Standing | None = None,
) -> State:
    """A viewer that has seen nothing but the background.

    Viewer 1 starts as the facade, viewer 2 as the flank (P47).

    Args:
        viewer: Its number.
        background: The picture without people.
        camera: Calibrated, at the working size; None: there is no calibration.
        settings: Of the run.
        method: What is done beyond the print.
        alone: It is the only viewer of the run.
        patches: What of the background changes, where a whole film was looked at before.
        standing: How tall the person stands, likewise.
    """
    proposed = method.proposals and (alone or camera is not None)
    return State(
        viewer,
        rotation_of(camera, viewer),
        settings,
        method,
        alone,
        camera_fault.init(background),
        silhouette.init(background, settings.silhouette, method),
        tuple(patches),
        not (proposed or method.stick_lifting),
        "facade" if viewer == 1 else "flank",
        standing,
    )


def step(state: State, frame: CapturedFrame, guide: Guide | None) -> tuple[State, Report]:
    """One frame: silhouette, opening posture, facing, position, arms, legs (P23).

    A picture that shows no scene (frozen, black, white) is told and not looked at.

    Args:
        state: What this viewer remembers.
        frame: The picture.
        guide: What the integrator made of the frame before; None at the start.
    """
    state, report, mask = look(state, frame, guide)
    return describe(state, report, mask, guide)


def look(state: State, frame: CapturedFrame, guide: Guide | None) -> tuple[State, Report, Mask]:
    """The silhouette of a frame, as a report that tells nothing else, and as a mask (H, W).

    Args:
        state: What this viewer remembers.
        frame: The picture.
        guide: What the integrator made of the frame before; None at the start.
    """
    watched, fault = camera_fault.step(state.fault, frame.picture)
    state = state._replace(fault=watched)
    if fault:
        nobody = Seen(np.zeros(frame.picture.shape[:2], np.bool_), None, 0, 0, cut=False)
        report = _report_of(state.viewer, frame, nobody)
        return state, msgspec.structs.replace(report, fault=fault), nobody.mask
    state = _patched(state, frame.index)
    remembered, seen = silhouette.step(state.silhouette, frame.picture, _near_px(state, guide))
    state = state._replace(silhouette=remembered, near_px=_middle_px(seen.box))
    return state, _report_of(state.viewer, frame, seen), seen.mask


def describe(state: State, report: Report, mask: Mask, guide: Guide | None) -> tuple[State, Report]:
    """A silhouette's report with all else that it shows.

    Args:
        state: What this viewer remembers.
        report: From `look`.
        mask: (H, W) the silhouette.
        guide: What the integrator made of the frame before; None at the start.
    """
    if report.box is None:
        return state._replace(squatting=False), report
    facing = guide.facing[state.viewer - 1] if guide is not None else state.vote
    measure, refusal = _opening(mask, report, guide, facing)
    report = msgspec.structs.replace(report, vote=state.vote, measure=measure, refusal=refusal)
    if state.method.stick_lifting or (guide is not None and guide.stick):
        return state, _with_stick(state, report, mask, guide)
    if not state.searches:
        return state, report
    return _searched(state, report, mask, guide)


def _report_of(viewer: ViewerNumber, frame: CapturedFrame, seen: Seen) -> Report:
    """What a silhouette alone tells."""
    height, width = seen.mask.shape
    return Report(
        frame=frame.index,
        captured_s=frame.captured_s,
        clock_s=frame.clock_s,
        viewer=viewer,
        width=width,
        height=height,
        silhouette=pack(seen.mask),
        box=seen.box,
        area_px=seen.area_px,
        blobs=seen.blobs,
        cut=seen.cut,
        next_s=frame.next_s,
    )


def _patched(state: State, index: int) -> State:
    """The state with the background as it is from a frame on."""
    due = [patch for patch in state.coming if patch.frame <= index]
    for patch in due:
        state = state._replace(silhouette=silhouette.patched(state.silhouette, patch))
    return state._replace(coming=state.coming[len(due) :]) if due else state


def _near_px(state: State, guide: Guide | None) -> Pixel | None:
    """Where the body is expected: by the integrator, or in the one view where it was last."""
    if _is_expected(guide, state.viewer):
        assert guide is not None
        return guide.root_px[state.viewer - 1]
    return state.near_px if state.alone else None


def _middle_px(box: Box | None) -> Pixel | None:
    if box is None:
        return None
    return (box.left + box.right + 1) / 2, (box.top + box.bottom + 1) / 2


def _with_stick(state: State, report: Report, mask: Mask, guide: Guide | None) -> Report:
    """The report with the stick body of a view that is alone (thesis 3.1.4)."""
    assert report.box is not None
    stature_px, expected = float(report.box.bottom + 1 - report.box.top), None
    if guide is not None and _is_expected(guide, state.viewer) and guide.bdp is not None:
        scale = guide.scale_px_per_m[state.viewer - 1]
        stature_px = scale * stature(guide.bdp)
        view = view_at(state.rotation, scale, guide.root_px[state.viewer - 1])
        body, pose = body_vector(guide.bdp), np.array(guide.pose)
        expected = stick_fit.expected(body, pose, view, stature_px)
    if state.standing is not None:
        stature_px = state.standing.at(report.box.bottom + 1)
    try:
        fitted = stick_fit.fit(mask, expected, stature_px, state.method)
    except stick_fit.NoBody:
        return report
    return msgspec.structs.replace(report, fit=stick_fit.told(fitted), score=fitted.score)


def _searched(
    state: State, report: Report, mask: Mask, guide: Guide | None
) -> tuple[State, Report]:
    """The report with what the search for the pose finds: facing, position, arms, legs."""
    known = guide if _is_expected(guide, state.viewer) else None
    facing = guide.facing[state.viewer - 1] if guide is not None else state.vote
    if known is not None:
        figure = _followed(state, mask, known)
    else:
        figure = _found(state, mask, report, guide)
    state, width_px, limits_px = _facing(state, mask, figure, known)
    figure = located(figure)
    figure, squatting = _limbs(state, figure, known, facing)
    names = FACADE_ANGLES + SQUAT_ANGLES if facing == "facade" else FLANK_ANGLES
    report = msgspec.structs.replace(
        report,
        upper_body_px=width_px,
        vote=state.vote,
        thresholds_px=limits_px,
        root_px=(float(figure.view[CENTRE_X]), float(figure.view[CENTRE_Y])),
        angles_deg={name: float(figure.pose[POSE_INDEX[name]]) for name in names},
        squatting=squatting,
        score=float(figure.score),
        matches=figure.matches,
    )
    return state._replace(squatting=squatting), report


def _is_expected(guide: Guide | None, viewer: ViewerNumber) -> bool:
    """Whether the integrator knows where in this view the body should be."""
    return (
        guide is not None
        and guide.status in FOLLOWED
        and guide.bdp is not None
        and guide.scale_px_per_m[viewer - 1] > 0.0
    )


def _followed(state: State, mask: Mask, guide: Guide) -> Figure:
    """The model where and how the guide expects it."""
    assert guide.bdp is not None
    n = state.viewer - 1
    pose = np.array(guide.pose)
    pose[:3] = 0.0
    view = view_at(state.rotation, guide.scale_px_per_m[n], guide.root_px[n])
    return figure_of(mask, body_vector(guide.bdp), pose, view)


def _found(state: State, mask: Mask, report: Report, guide: Guide | None) -> Figure:
    """The model at rest, laid into the silhouette's box: nothing is known of its pose.

    The body is the guide's if one was known before, else the thesis's proportions (T4).
    """
    assert report.box is not None
    bdp = thesis_bdp(1.0) if guide is None or guide.bdp is None else guide.bdp
    facing = state.vote if guide is None else guide.facing[state.viewer - 1]
    sole = report.box.bottom + 1
    scale = (sole - report.box.top) / stature(bdp)
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = yaw_of(facing, state.viewer)
    columns = np.arange(mask.shape[1]) + 0.5
    middle = float(np.average(columns, weights=mask.sum(axis=0)))
    legs_px = (bdp.r_upper_leg.height + bdp.r_lower_leg.height) * scale
    view = view_at(state.rotation, scale, (middle, sole - legs_px))
    return figure_of(mask, body_vector(bdp), pose, view)


def _opening(
    mask: Mask, report: Report, guide: Guide | None, facing: Facing
) -> tuple[Measure | None, str]:
    """What the opening posture tells, or why this is not it; nothing once measured."""
    assert report.box is not None
    if guide is not None and guide.measured:
        return None, ""
    if report.cut:
        return None, "the person is partly outside the picture"
    if facing == "flank":
        return measure_side(mask, report.box), ""
    refusal = refusal_of(mask, report.box)
    return (None, refusal) if refusal else (measure_front(mask, report.box), "")


def _facing(
    state: State, mask: Mask, figure: Figure, known: Guide | None
) -> tuple[State, float, tuple[float, float]]:
    """W_u-body and this view's vote; before a guide the start stands (P24-P26, P47)."""
    if known is None or known.bdp is None:
        return state, 0.0, (0.0, 0.0)
    scale = known.scale_px_per_m[state.viewer - 1]
    torso_px = known.bdp.torso.height * scale
    width_px = upper_body_px(mask, float(figure.view[CENTRE_Y]), torso_px)
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
            drop_m = (figure.view[CENTRE_Y] - known.rest_row_px[n]) / known.scale_px_per_m[n]
            squatting = squats(state.squatting, float(drop_m) / stature(known.bdp))
        return facade_legs(figure, settings, squatting), squatting
    near = 0 if state.rotation[0] @ [0.0, 0.0, 1.0] > 0.0 else 1
    return flank_legs(flank_arms(figure, settings, near, wide), settings, near), False
