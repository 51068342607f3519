"""The overlay of a run as a video: the tracked body drawn on its pictures."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from animator.overlay import SHOWN, overlay
from animator.video_codec import Picture
from animator.video_file import WrittenVideo, write_video
from common.body.body import Vector
from common.bus.messages import Body, View
from common.config.picture_size import size_within
from common.raster.silhouette_report import mask_of
from common.rig.upright_camera import as_worked_on
from common.video.decoding import Decoder
from common.video.pictures import Wanted
from runtime.offline.video_tracking import Followed
from runtime.terminal import Tell

STANDS_S: Final = 5.0
"""Longest display of a picture in the overlay, seconds, however long the gap after it."""


def write_overlay(found: Followed, path: Path, decoder: Decoder, tell: Tell) -> WrittenVideo:
    """Write the overlay beside the other files of a run.

    The video has a constant rate and the duration of the tracked one: where that one's rate varies,
    pictures are repeated or left out.

    Args:
        found: The result of one camera.
        path: Path of the video, without a suffix.
        decoder: Reads the tracked video again.
        tell: Receives the share of the frames drawn.

    Raises:
        VideoError: When it cannot be written.
        DecoderDied: When the video crashed the decoder.
    """
    time_s = np.array([report.captured_s for report in found.reports])
    gaps_s = np.diff(time_s)
    period_s = float(np.median(gaps_s)) if len(gaps_s) else found.period_s
    times = shown_times(time_s, period_s)

    def repeated() -> Iterator[Picture]:
        for n, picture in enumerate(overlaid(found, decoder)):
            yield from [picture] * int(times[n])
            tell((n + 1) / len(found.reports))

    return write_video(path, repeated(), 1 / period_s)


def shown_times(time_s: Vector, period_s: float) -> NDArray[np.int64]:
    """How often a video of constant rate shows each picture, (n,).

    Args:
        time_s: (n,) capture times, increasing.
        period_s: Time between pictures in the video.
    """
    places = np.rint((time_s - time_s[0]) / period_s).astype(np.int64)
    most = max(1, round(STANDS_S / period_s))
    return np.minimum(np.diff(places, append=places[-1] + 1), most)


def overlaid(found: Followed, decoder: Decoder) -> Iterator[Picture]:
    """Every frame with its silhouette and stick body, the lifted body beside it."""
    pictures = _pictures(found, decoder)
    for report, body, picture in zip(found.reports, found.bodies, pictures, strict=False):
        yield _drawn(found, report, body, picture)


def _drawn(found: Followed, report: View, body: Body, picture: Picture) -> Picture:
    joints_px, joints_m, confidence = np.full((15, 2), np.nan), np.full((15, 3), np.nan), [0.0] * 15
    if body.joints_m:
        joints_px = as_worked_on(np.array(body.joints_px[0]), report.upright)
        joints_px = joints_px * (picture.shape[1] / report.width)
        joints_m, confidence = found.to_camera(np.array(body.joints_m)), list(body.confidence)
    told = f"{body.frame}  {body.captured_s:.2f} s  {body.status}"
    if body.joints_m:
        told += f"  {np.mean(confidence):.2f}"
    return overlay(picture, mask_of(report), joints_px, joints_m, np.array(confidence), told)


def _pictures(found: Followed, decoder: Decoder) -> Iterator[Picture]:
    """The tracked frames; for masks, blank paper."""
    if found.clip is None:
        paper = np.full((found.size[1], found.size[0], 3), 255, np.uint8)
        yield from [paper] * len(found.reports)
        return
    view = found.clip.views[0]
    size = size_within(view.upright_source, SHOWN)
    wanted = Wanted(found.clip.every, quarters=view.quarters)
    for decoded in decoder.frames(view.source, size, wanted):
        yield decoded.picture
