"""A clip as one picture: some frames of its motion in both views, with the body's contour."""

from pathlib import Path
from typing import Final

import cv2
import numpy as np

from animator.page.inset import Image, draw_contours, inset, limb_contours, limb_ends
from animator.scene import figure
from common.bus.messages import Body, Picture, View, ViewerNumber, place_in_rig
from common.config import config_file
from common.method import Mode
from common.rig.camera import Rig
from common.video.clip_facts import whole_rig
from common.video.reduction import jpeg_of
from recognizer.__main__ import MOVING
from runtime.offline.lockstep import Decoders, track_clip
from runtime.offline.performance import Watch
from runtime.overrides import overridden
from viewer.captured_frame import CapturedFrame

SHOWN: Final = 8
"""Number of frames: enough for a motion of two or three seconds."""
WIDTH_PX: Final = 160
"""Width of each frame, pixels."""
LEVELS: Final = 0xF0
"""Mask of the bits of a colour that are kept: with their noise a page of strips would have 12
MB."""

Instant = tuple[dict[ViewerNumber, CapturedFrame], dict[int, View], tuple[Body, ...]]
"""Frames, reports and bodies of one instant."""


def contact_strip(path: Path, mode: Mode | None, decoders: Decoders) -> bytes:
    """A PNG with a row per view, SHOWN frames spread over the motion, silhouettes and limbs drawn
    in.

    Args:
        path: Clip folder or settings file.
        mode: Mode for tracking.
        decoders: Read its videos.

    Raises:
        ClipError: When the clip cannot be used.
    """
    instants: list[Instant] = []
    settings = overridden(config_file.load(path), mode, None)
    tracked = track_clip(
        settings, decoders, watch=Watch(lambda *now: instants.append(now), instants.clear)
    )
    moving = [now for now in instants if now[2][0].status in MOVING] or instants
    moving = moving[-settings.recognizer.window_frames :]
    chosen = [moving[i] for i in np.linspace(0, len(moving) - 1, SHOWN).round().astype(int)]
    rig, numbers = whole_rig(tracked.clip), [view.number for view in tracked.clip.views]
    rows = [np.hstack([_shown(now, number, rig) for now in chosen]) for number in numbers]
    _, png = cv2.imencode(".png", cv2.cvtColor(np.vstack(rows), cv2.COLOR_RGB2BGR))
    return bytes(png.tobytes())


def _shown(now: Instant, number: ViewerNumber, rig: Rig | None) -> Image:
    """One view of one instant; black where that camera has no frame then."""
    frames, reports, (body, *_) = now
    if number not in frames:
        any_picture = next(iter(frames.values())).picture
        return _fitted(np.zeros_like(any_picture))
    report = reports[number]
    jpeg = jpeg_of(frames[number].picture)
    seen = Picture(frame=0, captured_s=0.0, clock_s=0.0, viewer=number, jpeg=jpeg)
    image = inset(report, seen)
    drawn = figure(body)
    if drawn is not None and rig is not None:
        contours = limb_contours(rig.cameras[place_in_rig(number)], limb_ends(drawn))
        draw_contours(image, contours, report.width)
    return _fitted(image)


def _fitted(image: Image) -> Image:
    height = round(image.shape[0] * WIDTH_PX / image.shape[1])
    fitted: Image = cv2.resize(image, (WIDTH_PX, height), interpolation=cv2.INTER_AREA)
    return fitted & np.uint8(LEVELS)
