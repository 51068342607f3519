"""One camera's outlines to bodies: proposed, or lifted from a stick body where that is needed."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from common.body.body import Vector
from common.body.stick_body import ADULT, THESIS, pose_of
from common.bus.message_codec import pack
from common.bus.messages import Body, Report, ViewerNumber
from common.config import Settings
from common.notes.notes import Notes, held
from common.raster.bounds import box_of
from common.raster.similarity import Mask
from common.rig.camera import Camera
from integrator.rig.assumed_rig import assumed_camera
from integrator.single import single_view
from integrator.single.lifting import SWAPPED
from integrator.single.single_hypotheses import Inputs, Settled, State
from tritrack.single.single_silhouettes import Outline
from viewer.stick import stick_fit
from viewer.stick.standing_height import standing_rows, statures_px


class Poses(NamedTuple):
    """What outlines were made into."""

    bodies: list[Body]
    settled: list[Settled]
    """What was decided of each by itself."""
    stature_m: float


class Following(NamedTuple):
    """What one outline hands to the next."""

    view: State
    mode: stick_fit.Mode
    stick: Vector | None = None
    """The stick pose of the frame before."""


def poses_of(
    outlines: Sequence[Outline],
    size: tuple[int, int],
    camera: Camera | None,
    settings: Settings,
    period_s: float,
    notes: Notes,
    scale: float = 1.0,
    number: ViewerNumber = 1,
) -> Poses:
    """Outlines to bodies: the standing height, then the body of each frame.

    Args:
        outlines: In the order of time.
        size: Width and height of the picture.
        camera: Calibrated at that size; None: one is assumed.
        settings: Of the run; `thesis` mode follows the print.
        period_s: Between two frames.
        notes: The user's inputs.
        scale: Pixels of the working picture in one of the video.
        number: Which camera of a rig it is.
    """
    rows, tall_px = _standing(outlines, size[0])
    stature_m = settings.body.stature_m
    camera = camera or _assumed(size, rows[:, 1], tall_px, stature_m)
    mode: stick_fit.Mode = "thesis" if settings.mode == "thesis" else "default"
    printed = mode == "thesis"
    man = THESIS if printed else ADULT
    state = Following(single_view.init(number, camera, man, stature_m, printed, period_s), mode)
    bodies, settled = [], []
    for outline, stature_px in zip(outlines, tall_px.tolist(), strict=True):
        told = _inputs(notes, outline.frame, scale)
        state, body, own = step(state, outline, size[0], stature_px, told)
        bodies.append(body)
        settled.append(own)
    return Poses(bodies, settled, stature_m)


def step(
    state: Following, outline: Outline, width: int, stature_px: float, told: Inputs
) -> tuple[Following, Body, Settled]:
    """One outline more: a stick body is fitted only where what is proposed does not suffice.

    Args:
        state: What is remembered.
        outline: Of this frame.
        width: Of the picture, pixels.
        stature_px: How tall the person would stand in it.
        told: The user's inputs.
    """
    view = state.view
    mask = outline.mask(width)
    if not (outline.somebody and stature_px > 0.0):
        return _nobody(state, outline)
    report = _report(outline, mask, view.number)
    seen = single_view.glance(view, report, told)
    fitted: stick_fit.Stick | None = None
    if not seen.suffices:
        try:
            fitted = stick_fit.fit(mask, state.stick, state.mode, stature_px)
        except stick_fit.NoBody:
            return _nobody(state, outline)
        report = msgspec.structs.replace(report, fit=stick_fit.told(fitted), score=fitted.score)
    view, body, own = single_view.step(seen, report, told)
    pose = _drawn(view, body, own, stature_px) if fitted is None else fitted.pose
    return state._replace(view=view, stick=pose), body, own


def _nobody(state: Following, outline: Outline) -> tuple[Following, Body, Settled]:
    view, body, own = single_view.nobody(state.view, outline.frame, outline.captured_s)
    return state._replace(view=view, stick=None), body, own


def _drawn(view: State, body: Body, own: Settled, stature_px: float) -> Vector:
    """The stick pose that a body is seen as, r on the left of the picture (T10)."""
    joints_px = np.array(body.joints_px[view.number - 1])
    backward = own.orientation.startswith("backward")
    return pose_of(view.man, joints_px[SWAPPED] if backward else joints_px, stature_px)


def _standing(outlines: Iterable[Outline], width: int) -> tuple[Vector, Vector]:
    """Rows of crown and sole, (n, 2), and the standing height, (n,) pixels; NaN of nobody."""
    rows, whole = [], []
    for outline in outlines:
        rows.append(standing_rows(outline.mask(width)) if outline.somebody else (np.nan, np.nan))
        whole.append(outline.somebody and not outline.cut)
    both = np.array(rows).reshape(-1, 2)
    return both, statures_px(both[:, 0], both[:, 1], np.array(whole, np.bool_))


def _assumed(size: tuple[int, int], soles: Vector, tall_px: Vector, stature_m: float) -> Camera:
    """A camera that sees somebody of that stature as tall as most frames do."""
    stands = np.isfinite(tall_px)
    if not stands.any():
        return assumed_camera(size, float(size[1]), float(size[1]), stature_m)
    sole, tall = float(np.median(soles[stands])), float(np.median(tall_px[stands]))
    return assumed_camera(size, sole, tall, stature_m)


def _report(outline: Outline, mask: Mask, number: ViewerNumber) -> Report:
    box = box_of(mask)
    assert box is not None
    return Report(
        frame=outline.frame,
        captured_s=outline.captured_s,
        clock_s=outline.captured_s,
        viewer=number,
        width=mask.shape[1],
        height=mask.shape[0],
        silhouette=pack(mask),
        box=box,
        area_px=int(mask.sum()),
        blobs=1,
        cut=outline.cut,
        root_px=((box.left + box.right + 1) / 2, (box.top + box.bottom + 1) / 2),
    )


def _inputs(notes: Notes, frame: int, scale: float) -> Inputs:
    told = held(notes, frame)
    places = {name: (u * scale, v * scale) for name, (u, v) in told.joints_px.items()}
    return Inputs(told.orientation, told.depth, places)
