"""The overlay of a run's views as a video, and the frames of it that a report shows."""

import base64
from collections.abc import Collection, Iterator
from typing import Final, NamedTuple

import cv2
import numpy as np

from animator.report.report_page import Shot
from animator.video_codec import CODECS, Picture
from animator.video_file import write_video
from common.video.decoding import Decoder
from runtime.store.past_run import PastRun
from runtime.terminal import Tell
from tritrack.reporting.run_pictures import Moment, NoPictures, clip_of, moments, told_of
from tritrack.single.overlay_video import shown_times

SHOT_WIDTH: Final = 800
"""Largest width of a frame that a report shows, pixels."""
JPEG_QUALITY: Final = 80


class Drawn(NamedTuple):
    """The pictures of a run."""

    video: str
    """File name of the overlay."""
    shots: dict[int, Shot]
    """Frames as pictures, by row."""


def draw(run: PastRun, wanted: Collection[int], tell: Tell) -> Drawn:
    """Write the overlay of a run's views into its folder, but for a run of `tritrack single`, whose
    own overlay shows the silhouette too.

    The video has a constant rate and the duration of the run.

    Args:
        run: The run; its videos are read again.
        wanted: Rows whose frames are kept as pictures.
        tell: Receives the share that is done.

    Raises:
        NoPictures, DecoderDied, Undecodable: When its videos cannot be read any more.
        VideoError: When the video cannot be written.
    """
    with Decoder() as decoder:
        clip = clip_of(run, decoder)
    time_s = np.unique(np.asarray(run.poses["time_s"], float))
    if not len(time_s):
        raise NoPictures("there are no pictures: the run has no frame")
    period_s = (
        float(np.median(np.diff(time_s))) if len(time_s) > 1 else clip.every / clip.views[0].fps
    )
    often = dict(zip(time_s.tolist(), shown_times(time_s, period_s).tolist(), strict=True))
    shots: dict[int, Shot] = {}

    def pictures() -> Iterator[Picture]:
        for moment in moments(run, clip):
            shots.update(_shots(run, moment, wanted))
            tell(moment.share)
            yield from [moment.picture] * often[float(run.poses["time_s"][moment.rows[0]])]

    own = _own_overlay(run)
    if own:
        for _ in pictures():
            pass
        return Drawn(own, shots)
    return Drawn(write_video(run.folder / "overlay", pictures(), 1 / period_s).path.name, shots)


def _own_overlay(run: PastRun) -> str:
    """File name of the overlay that `tritrack single` wrote; "" where there is none."""
    if (run.summary.get("run_of") or {}).get("command") != "single":
        return ""
    names = (f"overlay{codec.suffix}" for codec in CODECS)
    return next((name for name in names if (run.folder / name).is_file()), "")


def _shots(run: PastRun, moment: Moment, wanted: Collection[int]) -> dict[int, Shot]:
    """The wanted rows of a moment, with its picture."""
    rows = [row for row in moment.rows if row in wanted]
    return {row: Shot(_data_uri(moment.picture), told_of(run, row)) for row in rows}


def _data_uri(picture: Picture) -> str:
    scale = min(1.0, SHOT_WIDTH / picture.shape[1])
    smaller = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    _, encoded = cv2.imencode(".jpg", smaller, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return f"data:image/jpeg;base64,{base64.b64encode(encoded.tobytes()).decode()}"
