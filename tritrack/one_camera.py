"""One camera's clip to its bodies: outlines first, then stick bodies, lifted (thesis 3.1)."""

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body import LIMBS
from common.camera import PAPER_ROTATIONS, Camera
from common.clip_facts import Clip, shortfall
from common.config import Settings
from common.decoding import Decoder
from common.messages import Body, Box, Fit, Report, ViewerNumber
from common.notes import Notes, held
from common.reel import Reel
from common.similarity import Mask
from common.stickman import ADULT, THESIS
from common.wire import pack
from integrator import one_view
from integrator.assumed import assumed_camera
from integrator.one_outline import Inputs, Settled
from tritrack.first_pass import Outline, outlines_of
from viewer import stick
from viewer.background import Background
from viewer.empty import room_of_clip
from viewer.standing import standing_rows, statures_px


class Followed(NamedTuple):
    """What one camera gave."""

    bodies: list[Body]
    settled: list[Settled]
    outlines: list[Outline]
    size: tuple[int, int]
    """Width and height of the working picture."""
    rate_hz: float
    turn: NDArray[np.float64]
    """World to camera, (3, 3)."""
    clip: Clip | None
    """None of a sequence of masks, likewise `room`."""
    room: Background | None
    facts: dict[str, Any]

    def to_camera(self, joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Joints with x to the right of the picture, y up, z to the camera."""
        return joints_m @ self.turn.T * (1.0, -1.0, -1.0)


def follow_clip(clip: Clip, settings: Settings, decoder: Decoder, notes: Notes) -> Followed:
    """Track a clip of one view.

    Raises:
        ClipError: When it is too long, or its camera moves.
        DecoderDied: When the video broke the decoder.
    """
    began = time.perf_counter()
    view = clip.views[0]
    reel = Reel(decoder)
    room, anchor, odd = room_of_clip(view, settings.silhouette, reel)
    ready = time.perf_counter()
    outlines = outlines_of(clip, room, anchor, settings.silhouette, reel)
    cut_off = shortfall(view, reel.came)
    camera = clip.rig.cameras[0] if clip.rig is not None else None
    period_s = clip.every / view.fps
    scale = view.size[0] / view.source_size[0]
    seen = time.perf_counter()
    bodies, settled, stature_m = poses_of(
        outlines, view.size, camera, settings, period_s, notes, scale, view.number
    )
    done = time.perf_counter()
    facts = {
        "clip": clip.name,
        "performer": clip.meta.performer,
        "posture_meant": clip.meta.posture,
        "seconds": {
            "background": round(ready - began, 4),
            "silhouettes": round(seen - ready, 4),
            "poses": round(done - seen, 4),
            "all": round(done - began, 4),
        },
        "frames_a_second": round(len(bodies) / max(done - ready, 1e-9), 1),
        "scale_source": "assumed" if camera is None else "calibrated",
        "stature_m": round(stature_m, 3),
        "trembles": anchor is not None,
        "never_uncovered": round(float(room.uncertain.mean()), 4),
        "warnings": [*clip.warnings, *filter(None, (odd, cut_off, _nobody_in(bodies)))],
    }
    turn = np.array(PAPER_ROTATIONS[0] if camera is None else camera.R)
    return Followed(bodies, settled, outlines, view.size, 1 / period_s, turn, clip, room, facts)


def follow_masks(
    name: str, outlines: list[Outline], size: tuple[int, int], settings: Settings
) -> Followed:
    """The same for silhouettes that were cut out before."""
    began = time.perf_counter()
    period_s = outlines[1].captured_s - outlines[0].captured_s if len(outlines) > 1 else 0.04
    bodies, settled, stature_m = poses_of(outlines, size, None, settings, period_s, Notes())
    spent = time.perf_counter() - began
    facts = {
        "clip": name,
        "seconds": {"poses": round(spent, 4), "all": round(spent, 4)},
        "frames_a_second": round(len(bodies) / max(spent, 1e-9), 1),
        "scale_source": "assumed",
        "stature_m": round(stature_m, 3),
        "warnings": list(filter(None, (_nobody_in(bodies),))),
    }
    turn = np.array(PAPER_ROTATIONS[0])
    return Followed(bodies, settled, outlines, size, 1 / period_s, turn, None, None, facts)


def poses_of(
    outlines: Sequence[Outline],
    size: tuple[int, int],
    camera: Camera | None,
    settings: Settings,
    period_s: float,
    notes: Notes,
    scale: float = 1.0,
    number: ViewerNumber = 1,
) -> tuple[list[Body], list[Settled], float]:
    """Outlines to bodies: the standing height, the stick body of each frame, its place in space.

    Args:
        outlines: In the order of time.
        size: Width and height of the picture.
        camera: Calibrated at that size; None: one is assumed.
        settings: Of the run; `thesis` mode follows the print.
        period_s: Between two frames.
        notes: The user's inputs.
        scale: Pixels of the working picture in one of the video.
        number: Which camera of a rig it is.

    Returns:
        A body and what was settled by itself for each outline; the stature, metres.
    """
    width = size[0]
    rows = np.array(
        [standing_rows(o.mask(width)) if o.somebody else (np.nan, np.nan) for o in outlines]
    ).reshape(-1, 2)
    whole = np.array([o.somebody and not o.cut for o in outlines], np.bool_)
    tall_px = statures_px(rows[:, 0], rows[:, 1], whole)
    stature_m = settings.body.stature_m
    if camera is None:
        stands = np.isfinite(tall_px)
        sole, tall = (
            (float(np.median(rows[stands, 1])), float(np.median(tall_px[stands])))
            if stands.any()
            else (float(size[1]), float(size[1]))
        )
        camera = assumed_camera(size, sole, tall, stature_m)
    printed = settings.mode == "thesis"
    man = THESIS if printed else ADULT
    state = one_view.init(number, camera, man, stature_m, printed, period_s)
    mode: stick.Mode = "thesis" if printed else "default"
    before: stick.Stick | None = None
    bodies, settled = [], []
    for outline, stature_px in zip(outlines, tall_px, strict=True):
        mask = outline.mask(width)
        before = _fitted(mask, before, mode, float(stature_px))
        if before is not None:
            report = _report(outline, mask, number, stick.told(before))
            state, body, own = one_view.step(state, report, _inputs(notes, outline.frame, scale))
        else:
            state, body, own = one_view.nobody(state, outline.frame, outline.captured_s)
        bodies.append(body)
        settled.append(own)
    return bodies, settled, stature_m


def extras_of(settled: Sequence[Settled]) -> dict[str, Any]:
    """What `poses.npz` of a single view has beside the arrays of every run."""
    limbs = {
        name: np.array([getattr(own, name) for own in settled]).reshape(-1, len(LIMBS))
        for name in ("depth_confidence", "depth_error_deg")
    }
    return {
        "orientation": np.array([own.orientation for own in settled], "U14"),
        "orientation_confidence": np.array([own.orientation_confidence for own in settled]),
        **limbs,
    }


def _nobody_in(bodies: Sequence[Body]) -> str:
    """What is odd where no frame shows anybody; "" otherwise."""
    if any(body.joints_m for body in bodies):
        return ""
    return "nobody was seen: the person must move, and be a sixth of the picture high at least"


def _fitted(
    mask: Mask, before: stick.Stick | None, mode: stick.Mode, stature_px: float
) -> stick.Stick | None:
    """The stick body of a silhouette; None where it shows nobody, or too little of anybody."""
    try:
        return stick.fit(mask, before, mode, stature_px)
    except stick.NoBody:
        return None


def _report(outline: Outline, mask: Mask, number: ViewerNumber, fit: Fit) -> Report:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    left, right, top, bottom = (int(x) for x in (*columns[[0, -1]], *rows[[0, -1]]))
    return Report(
        frame=outline.frame,
        captured_s=outline.captured_s,
        clock_s=outline.captured_s,
        viewer=number,
        width=mask.shape[1],
        height=mask.shape[0],
        silhouette=pack(mask),
        box=Box(left=left, right=right, top=top, bottom=bottom),
        area_px=int(mask.sum()),
        blobs=1,
        cut=outline.cut,
        root_px=((left + right + 1) / 2, (top + bottom + 1) / 2),
        fit=fit,
        score=fit.score,
    )


def _inputs(notes: Notes, frame: int, scale: float) -> Inputs:
    told = held(notes, frame)
    places = {name: (u * scale, v * scale) for name, (u, v) in told.joints_px.items()}
    return Inputs(told.orientation, told.depth, places)
