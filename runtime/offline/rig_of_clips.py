"""One rig from the person in all clips that it recorded."""

from collections.abc import Sequence
from contextlib import ExitStack
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from calibration.person.many_calibration import calibrated_by_all
from calibration.person.rig_quality import Quality
from calibration.tracks.camera_clocks import Clocks
from common.config import config_file
from common.config.part_settings import BodySettings
from common.method import METHODS
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError, fitted, is_of_shape
from common.video.clip_facts import Clip
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import Reader, Size
from runtime.offline.rig_from_person import believed_clocks, sightings_of
from runtime.sound_clocks import by_ear, heard_words
from runtime.steps.frame_cache import FrameCache
from viewer.landmarks.landmark_sources import outside_sources


class Given(NamedTuple):
    """The user's knowledge of a rig."""

    stature_m: float = BodySettings().stature_m
    fov_deg: float | None = None
    """Field of view of the cameras."""


class FoundByClips(NamedTuple):
    """A rig, and further results from the clips."""

    rig: Rig
    """At the size of their pictures."""
    quality: Quality
    clocks: Clocks
    """In each clip, the clocks of the views after the first, one after the other."""
    heard: tuple[str, ...] = ()
    """What the videos' sounds tell of their delays, in words: these are set back already."""


def calibrated_by_clips(paths: Sequence[Path], given: Given) -> FoundByClips:
    """One rig from all clips that it recorded.

    Raises:
        CalibrationError: When too little of a person is seen, or the clips are of two rigs.
        ClipError, SettingsError, DecoderDied, Undecodable: When a clip cannot be used.
    """
    method = METHODS["default"]
    films, clocks, sizes = [], [], list[tuple[Size, ...]]()
    names, heard = list[str](), list[str]()
    with ExitStack() as doors:
        decoders: list[Reader] = []
        for path in paths:
            settings = config_file.load(path)
            clip, settings, late_s = by_ear(open_clip(settings), settings)
            heard += heard_words(str(path), late_s)
            names = names or [view.name for view in clip.views]
            _refuse_another_rig(path, clip, names)
            sizes.append(tuple(view.source_size for view in clip.views))
            while len(decoders) < len(names):
                decoders.append(doors.enter_context(Decoder()))
            readers = {
                v.number: FrameCache(one) for v, one in zip(clip.views, decoders, strict=True)
            }
            with outside_sources(settings, clip.views) as sources:
                films.append(sightings_of(clip, settings, method, readers, sources))
            clocks.append(believed_clocks(clip, settings, films[-1]))
    size = sizes[0][0]
    if set(sizes) != {sizes[0]} or not all(is_of_shape(each, size) for each in sizes[0]):
        told = ", ".join(f"{width}x{height}" for width, height in sorted(set(chain(*sizes))))
        raise CalibrationError(f"pictures of several sizes ({told}) are not of one rig")
    found = calibrated_by_all(tuple(films), given.stature_m, given.fov_deg, tuple(clocks))
    rig = fitted(found.rig, size, "the calibration")
    return FoundByClips(rig, found.quality, found.clocks, tuple(heard))


def _refuse_another_rig(path: Path, clip: Clip, names: Sequence[str]) -> None:
    """Refuse a clip without several recorded views, or with other cameras than the first clip's."""
    if len(clip.views) < 2 or not all(view.frames for view in clip.views):
        raise CalibrationError(f"{path} has not two recorded views: name clips of several cameras")
    own = [view.name for view in clip.views]
    if own != names:
        raise CalibrationError(
            f"{path} has the cameras {', '.join(own)}, the first clip {', '.join(names)}: name "
            "clips of one rig"
        )
