"""One camera's clip to its bodies: outlines first, then stick bodies, lifted (thesis 3.1)."""

import time
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import LIMBS
from common.bus.messages import Body
from common.config import Settings
from common.notes.notes import Notes
from common.rig.camera import PAPER_ROTATIONS
from common.video.clip_facts import Clip, shortfall
from common.video.decoding import Decoder
from common.video.frame_cache import Reel
from integrator.single.single_hypotheses import Settled
from tritrack.single.one_camera_poses import poses_of
from tritrack.single.single_silhouettes import Outline, outlines_of
from viewer.background.background import Background
from viewer.background.background_source import room_of_clip

FITS: Final = 0.6
"""S from which a pose fits its outline."""
MOSTLY: Final = 0.5
"""Where fewer of the poses fit, that is said."""


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
    scene = room_of_clip(view, settings.silhouette, reel)
    room = scene.room
    ready = time.perf_counter()
    outlines = outlines_of(clip, scene, settings.silhouette, reel)
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
        "trembles": scene.anchor is not None,
        "never_uncovered": round(float(room.uncertain.mean()), 4),
        "warnings": [*clip.warnings, *filter(None, (scene.odd, cut_off, _doubtful(bodies)))],
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
        "warnings": list(filter(None, (_doubtful(bodies),))),
    }
    turn = np.array(PAPER_ROTATIONS[0])
    return Followed(bodies, settled, outlines, size, 1 / period_s, turn, None, None, facts)


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


def _doubtful(bodies: Sequence[Body]) -> str:
    """What is odd where no frame shows anybody, or few poses fit what they show; "" otherwise."""
    scores = [max(body.score) for body in bodies if body.joints_m]
    if not scores:
        return "nobody was seen: the person must move, and be a sixth of the picture high at least"
    fit = float(np.mean(np.array(scores) >= FITS))
    if fit >= MOSTLY:
        return ""
    return (
        f"only {fit:.0%} of the poses fit their outlines: the camera or its light may move, or "
        "what is outlined in the overlay is not one person"
    )
