"""The pictures of a run's views, instant by instant, with its bodies drawn on them."""

import math
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from typing import Final, NamedTuple

import cv2
import msgspec
import numpy as np

from animator.overlay import INK, PAPER, draw_stick
from animator.video_codec import Picture
from common.bus.messages import ViewerNumber
from common.config.explained import explained
from common.config.part_settings import SettingsError
from common.config.picture_size import size_within
from common.config.renamed_settings import settings_of
from common.config.settings import Settings
from common.npz_file import Facts
from common.rig.upright_camera import as_worked_on
from common.video.clip_facts import Clip, ClipView
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import is_recorded
from runtime.live.run_folder import PICTURES
from runtime.offline.frame_pairs import instants
from runtime.store.past_run import PastRun
from viewer.captured_frame import CapturedFrame

SHOWN: Final = (640, 480)
"""Largest size of a view's picture where there are two, pixels."""
SMALL: Final = (480, 360)
"""The same where there are more."""
BAR_PX: Final = 28
"""Height of the line of text below the pictures."""
TOUCH_S: Final = 1e-4
"""Largest difference of the times of a row and of its instant."""
FONT: Final = cv2.FONT_HERSHEY_SIMPLEX


class NoPictures(RuntimeError):
    """A run whose pictures cannot be shown: the text says why, and the cure."""


class Moment(NamedTuple):
    """One instant of a run as a picture."""

    rows: tuple[int, ...]
    """The rows of the run; one for each person."""
    picture: Picture
    share: float
    """Share of the run until then."""


def clip_of(run: PastRun, decoder: Decoder) -> Clip:
    """The run's videos, with the delays that were applied.

    Raises:
        NoPictures: When they are not videos, or cannot be opened any more.
    """
    settings, posed = _settings_of(run), np.asarray(run.poses["seen"]).any(axis=0)
    numbers = tuple((np.flatnonzero(posed) + 1).tolist()) or (1,)
    try:
        clip = open_clip(
            msgspec.structs.replace(settings, trust_calibration=True), decoder, numbers
        )
    except (ClipError, SettingsError) as error:
        raise NoPictures(f"there are no pictures: {error}") from error
    if not all(is_recorded(view.source) for view in clip.views):
        kept = run.folder / PICTURES
        raise NoPictures(
            f"what the cameras of this live run showed is a clip of its own: tritrack track {kept}"
            if kept.is_dir()
            else "there are no pictures: the run is of cameras, which keep none"
        )
    return msgspec.structs.replace(clip, views=tuple(_late(run, view) for view in clip.views))


def _settings_of(run: PastRun) -> Settings:
    try:
        return settings_of(run.summary.get("settings", {}))
    except (msgspec.ValidationError, SettingsError) as error:
        why = error if isinstance(error, SettingsError) else explained(error, Settings)
        raise NoPictures(f"there are no pictures: {run.folder}/summary.json: {why}") from error


def _late(run: PastRun, view: ClipView) -> ClipView:
    """The view with the delay that the run applied."""
    told: Facts = run.summary.get("clocks", {}).get(view.name) or run.summary.get("clock") or {}
    if view.number == 1 or "applied_s" not in told:
        return view
    return msgspec.structs.replace(view, late_s=float(told["applied_s"]))


def moments(run: PastRun, clip: Clip) -> Iterator[Moment]:
    """Every instant of a run that has rows, in the order of time.

    A view without a picture of the instant keeps the one before.
    """
    time_s = np.asarray(run.poses["time_s"], float)
    shown = SHOWN if len(clip.views) <= 2 else SMALL
    sizes = {view.number: size_within(view.upright_source, shown) for view in clip.views}
    larger = tuple(msgspec.structs.replace(view, size=sizes[view.number]) for view in clip.views)
    last = {n: np.full((h, w, 3), PAPER, np.uint8) for n, (w, h) in sizes.items()}
    by_number = {view.number: view for view in clip.views}
    with ExitStack() as doors:
        readers = {view.number: doors.enter_context(Decoder()) for view in clip.views}
        for frames in instants(msgspec.structs.replace(clip, views=larger), readers, {}):
            last |= {number: frame.picture for number, frame in frames.items()}
            at_s = max(frame.captured_s for frame in frames.values())
            rows = tuple(np.flatnonzero(np.abs(time_s - at_s) <= TOUCH_S).tolist())
            if rows:
                drawn = _drawn(run, by_number, last, frames, rows)
                yield Moment(rows, drawn, (rows[-1] + 1) / len(time_s))


def _drawn(
    run: PastRun,
    views: Mapping[ViewerNumber, ClipView],
    pictures: Mapping[ViewerNumber, Picture],
    frames: Mapping[ViewerNumber, CapturedFrame],
    rows: tuple[int, ...],
) -> Picture:
    """The views beside each other, and a line of text below."""
    tiles = [_tile(run, views[n], picture, n in frames, rows) for n, picture in pictures.items()]
    high = max(tile.shape[0] for tile in tiles)
    tiles = [_padded(tile, high) for tile in tiles]
    beside = len(tiles) if len(tiles) <= 3 else math.ceil(math.sqrt(len(tiles)))
    lines = [np.hstack(tiles[n : n + beside]) for n in range(0, len(tiles), beside)]
    wide = max(line.shape[1] for line in lines)
    lines = [
        cv2.copyMakeBorder(line, 0, 0, 0, wide - line.shape[1], 0, None, PAPER) for line in lines
    ]
    whole = np.vstack([*lines, _bar(run, rows[0], wide)])
    return np.ascontiguousarray(whole[: whole.shape[0] // 2 * 2, : whole.shape[1] // 2 * 2])


def _tile(
    run: PastRun, view: ClipView, picture: Picture, is_new: bool, rows: tuple[int, ...]
) -> Picture:
    """One view with the bodies drawn on it, and its name; a picture from before is pale."""
    drawn = picture.copy() if is_new else cv2.addWeighted(picture, 0.5, picture, 0, 110)
    scale = drawn.shape[1] / view.size[0]
    for row in rows:
        joints_px = as_worked_on(run.poses["joints_px"][row, view.number - 1], view.upright)
        draw_stick(drawn, joints_px * scale, run.poses["confidence"][row])
    seen = run.poses["seen"][list(rows), view.number - 1].any()
    told = view.name + ("" if seen else ": no person")
    cv2.putText(drawn, told, (9, 21), FONT, 0.55, (0, 0, 0), 3, cv2.LINE_AA)
    cv2.putText(drawn, told, (8, 20), FONT, 0.55, (255, 255, 255), 1, cv2.LINE_AA)
    return drawn


def _padded(tile: Picture, high: int) -> Picture:
    below = high - tile.shape[0]
    padded: Picture = cv2.copyMakeBorder(tile, 0, below, 0, 0, cv2.BORDER_CONSTANT, None, PAPER)
    return padded


def _bar(run: PastRun, row: int, wide: int) -> Picture:
    bar = np.full((BAR_PX, wide, 3), PAPER, np.uint8)
    cv2.putText(bar, told_of(run, row), (8, 19), FONT, 0.48, INK, 1, cv2.LINE_AA)
    return bar


def told_of(run: PastRun, row: int) -> str:
    """A frame's number, time, status and mean confidence."""
    poses = run.poses
    sure = float(np.mean(poses["confidence"][row]))
    status = str(poses["status"][row])
    told = f"frame {int(poses['frame'][row])}, {float(poses['time_s'][row]):.2f} s, {status}"
    return told + ("" if status in ("empty", "lost") else f", confidence {sure:.2f}")
