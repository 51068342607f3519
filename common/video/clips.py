"""Clips: the sources of a run's frames, checked before it begins."""

import math
from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from typing import Final

import msgspec

from common.bus.messages import ViewerNumber, place_in_rig
from common.config.explained import explained
from common.config.picture_size import size_of, working_size
from common.config.settings import Settings
from common.rig.absurd_rig import nearly_one_view, refuse_absurd
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError, fitted, load_rig
from common.video.camera_file import kept_times, timing_of
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.clip_sources import (
    NOTHING,
    ClipError,
    ViewSource,
    companions_folder,
    offsets_of,
    refuse_a_lost_head,
    refuse_unreadable,
    sources_of,
)
from common.video.decoding import Decoder
from common.video.frame_times import timed
from common.video.pictures import DecoderDied, Source, Undecodable, VideoInfo, is_recorded
from common.video.shared_rate import at_one_rate
from common.video.upright_views import filed_rig, upright_views
from common.video.view_pair import refuse_missing, refuse_same_source

SAME_ASPECT: Final = 0.02
"""Largest difference of aspect ratios at which two sizes show the same picture."""
CAMERA_HZ: Final = 15.0
"""Frame rate assumed for a camera that reports none: the paper's (P1)."""


def open_clip(
    settings: Settings,
    decoder: Decoder | None = None,
    numbers: Collection[ViewerNumber] | None = None,
) -> Clip:
    """Open and check the sources of a run's pictures.

    Args:
        settings: They name a clip folder, or a file or camera for each view, or both: a view's own
            source takes precedence.
        decoder: Reads the files; None: a new one. Passing one saves its start.
        numbers: The cameras to open; the others may be on other hosts and are not touched. None:
            all.

    Raises:
        ClipError: When something is missing, empty, no video, or inconsistent; when two views are
            of one camera; when the calibration's cameras cannot be matched.
    """
    found = sources_of(settings)
    if not found:
        raise ClipError(NOTHING)
    refuse_missing(settings, found, numbers)
    named = [each for each in found if numbers is None or each.number in numbers]
    folder = companions_folder(settings, named)
    meta = _meta(folder)
    with ExitStack() as doors:
        reader = decoder or doors.enter_context(Decoder())
        each_view = tuple(_view(each, settings, meta, reader) for each in named)
    refuse_same_source(named)
    views = at_one_rate(each_view, settings.every)
    rig = _rig(settings, folder, found, views)
    if rig is not None:
        rig, views = upright_views(rig, views)
    clip = Clip(
        name=folder.resolve().name if settings.clip else Path(str(named[0].source)).stem,
        views=views,
        every=settings.every,
        rig=rig,
        meta=meta,
        warnings=tuple(_oddities(views, meta, rig)),
    )
    if not settings.trust_calibration:
        _refuse_absurd(clip)
    return clip


def _refuse_absurd(clip: Clip) -> None:
    try:
        rig = filed_rig(clip)
        if rig is not None:
            refuse_absurd(rig, clip.name)
    except CalibrationError as error:
        raise ClipError(str(error)) from error


def meta_of(settings: Settings) -> Meta:
    """The content of `meta.json` beside a clip's videos, which are not opened.

    Raises:
        ClipError: When there is no such clip, or the file cannot be read.
    """
    return _meta(companions_folder(settings, sources_of(settings)))


def find_calibration(settings: Settings, folder: Path) -> Path | None:
    """The calibration of a run: the one named, else the clip's, else its parent folder's."""
    if settings.calibration:
        return Path(settings.calibration)
    for place in (folder, folder.resolve().parent):
        if (place / "calibration.json").is_file():
            return place / "calibration.json"
    return None


def _meta(folder: Path) -> Meta:
    path = folder / "meta.json"
    content = b""
    try:
        content = path.read_bytes()
        meta = msgspec.json.decode(content, type=Meta)
    except FileNotFoundError:
        left = kept_times(folder)  # by a recording that was killed
        return msgspec.convert(timing_of(left), Meta) if left else Meta()
    except (OSError, msgspec.DecodeError, RecursionError) as error:
        why = error.strerror if isinstance(error, OSError) else explained(error, Meta, content)
        raise ClipError(f"cannot read {path} ({why}): mend it or take it away") from error
    for told_hz in meta.fps.values() if isinstance(meta.fps, dict) else (meta.fps,):
        if told_hz is not None and not (math.isfinite(told_hz) and told_hz > 0):
            raise ClipError(f"{path} names a rate of {told_hz} frames a second: mend or remove fps")
    for name, moments in meta.capture_s.items():
        if not all(earlier < later for earlier, later in pairwise(moments)):
            raise ClipError(f"{path}: capture_s of {name} does not increase: mend or remove it")
    return meta


def _view(named: ViewSource, settings: Settings, meta: Meta, decoder: Decoder) -> ClipView:
    info = timed(probed(named.source, decoder))
    if named.settings.background:
        _refuse_another_scene(named, probed(named.settings.background, decoder), info)
    of_a_file = is_recorded(named.source)
    told_hz = settings.fps or meta.fps_of(named.name)
    fps = (told_hz or info.fps) if of_a_file else (info.fps or CAMERA_HZ)
    refuse_no_video(named.source, info.frames, fps)
    size = (info.width, info.height)
    return ClipView(
        number=named.number,
        name=named.name,
        source=named.source,
        source_size=size,
        size=working_size(size, size_of(settings.size)),
        fps=fps,
        frames=info.frames if of_a_file else 0,
        capture_s=_told_s(meta, named) or (() if told_hz else info.shown_s),
        background=named.settings.background,
        late_s=offsets_of(settings).get(named.number, 0.0),
    )


def _told_s(meta: Meta, named: ViewSource) -> tuple[float, ...]:
    """Capture times of a file's frames, from the files beside it."""
    return meta.capture_s.get(named.name, ()) if is_recorded(named.source) else ()


def probed(source: Source, decoder: Decoder) -> VideoInfo:
    """The facts of a file or camera.

    Raises:
        ClipError: When it does not exist, cannot be read, is empty, or has no picture.
    """
    if is_recorded(source):
        refuse_unreadable(Path(source))
    try:
        info = decoder.probe(source)
    except (Undecodable, DecoderDied) as error:
        raise ClipError(str(error)) from error
    if is_recorded(source):
        refuse_a_lost_head(Path(source))
    return info


def refuse_no_video(source: Source, frames: int, fps: float) -> None:
    """Refuse a single picture, or what has no frame rate, in the place of a video.

    Raises:
        ClipError: When it is one.
    """
    if fps > 0:
        return
    if frames == 1:
        raise ClipError(f"{source} is one picture, no video: name a video")
    raise ClipError(f"{source} has no frame rate: set fps in a meta.json beside it")


def _refuse_another_scene(named: ViewSource, plate: VideoInfo, info: VideoInfo) -> None:
    """A picture of another shape was cropped, or comes from another camera; the size does not
    matter."""
    aspect = plate.width * info.height / (plate.height * info.width)
    if abs(aspect - 1.0) > SAME_ASPECT:
        raise ClipError(
            f"the background {named.settings.background} has {plate.width}x{plate.height} pixels, "
            f"{named.source} {info.width}x{info.height}: take an empty frame of the same camera, "
            "uncropped"
        )


def _rig(
    settings: Settings, folder: Path, found: Sequence[ViewSource], views: tuple[ClipView, ...]
) -> Rig | None:
    """The calibration of the cameras in use, at their working size."""
    path = find_calibration(settings, folder)
    if path is None:
        return None
    try:
        rig = load_rig(path)
        places = _places(rig, found, [view.number for view in views], path)
        cameras = tuple(
            fitted(fitted(rig, view.source_size, str(path)), view.size, str(path)).cameras[place]
            for view, place in zip(views, places, strict=True)
        )
    except CalibrationError as error:
        raise ClipError(str(error)) from error
    return msgspec.structs.replace(rig, cameras=cameras)


def _places(
    rig: Rig, found: Sequence[ViewSource], wanted: Sequence[ViewerNumber], path: Path
) -> list[int]:
    """Indices of cameras in a calibration: by the settings' names, by name, or by number.

    Raises:
        ClipError: When the calibration lacks one, or has other cameras and different names.
    """
    names = [camera.name for camera in rig.cameras]
    by_name = all(one.name in names for one in found if not one.settings.calibrated_as)
    places = []
    for one in (each for each in found if each.number in wanted):
        called = one.settings.calibrated_as or (one.name if by_name else "")
        if called and called not in names:
            raise ClipError(f"{path} has no camera {called!r}; it has {', '.join(names)}")
        if not called and len(names) > max(2, len(found)):
            raise ClipError(
                f"{path} has {len(names)} cameras ({', '.join(names)}): say which of them took "
                f"view {one.number}, by cameras.{one.name}.calibrated_as in the settings, or keep "
                "those of the clip (tritrack calibrate import --camera NAME --camera NAME)"
            )
        lone = len(wanted) == len(names) == 1
        places.append(names.index(called) if called else 0 if lone else place_in_rig(one.number))
        if places[-1] >= len(names):
            has = f"{len(names)} camera{'s' if len(names) > 1 else ''}"
            raise ClipError(
                f"{path} has {has}, the clip has a view {one.number}: calibrate all, or set "
                f"cameras.{one.name}.calibrated_as"
            )
    return places


def _oddities(views: tuple[ClipView, ...], meta: Meta, rig: Rig | None) -> Iterator[str]:
    for view in views:
        told_s = meta.capture_s.get(view.name, ())
        if told_s and view.frames and len(told_s) != view.frames:
            yield (
                f"meta.json has {len(told_s)} capture times for camera {view.number}, "
                f"{view.source} has {view.frames} frames"
            )
    for view in (view for view in views if view.picked):
        yield (
            f"the views differ in rate: of the {view.known_frames} frames of {view.source} those "
            f"{len(view.picked)} are looked at that meet the other's, {view.fps:g} a second"
        )
    for one, other in pairwise(views):
        if one.source_size != other.source_size:
            sizes = "{}x{} and {}x{}".format(*one.source_size, *other.source_size)
            yield f"the views differ in size: {sizes}"
        plain = not (one.capture_s or other.capture_s)
        if plain and one.frames and other.frames and one.frames != other.frames:
            yield f"the views differ in length: {one.frames} and {other.frames} frames"
    if rig is not None and (odd := nearly_one_view(rig)):
        yield odd
