"""One rig from the person in all clips that it recorded."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from calibration.person.person_calibration import calibrated_by_person
from calibration.person.rig_quality import Quality
from calibration.tracks.lateness import Clock, clock_of
from common.config import config_file
from common.config.part_settings import BodySettings
from common.method import METHODS
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError, fitted
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.frame_cache import FrameCache
from common.video.pictures import Reader
from runtime.offline.rig_from_person import ON_TIME, sighting_of
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
    clocks: tuple[Clock, ...]
    """Clock of view 2 in each clip."""


def calibrated_by_clips(paths: Sequence[Path], given: Given) -> FoundByClips:
    """One rig from all clips that it recorded.

    Raises:
        CalibrationError: When too little of a person is seen, or the clips are of two rigs.
        ClipError, SettingsError, DecoderDied, Undecodable: When a clip cannot be used.
    """
    method = METHODS["default"]
    sightings, clocks, sizes = [], [], set()
    with ExitStack() as doors:
        decoders: list[Reader] = [doors.enter_context(Decoder()) for _ in range(2)]
        for path in paths:
            settings = config_file.load(path)
            clip = open_clip(settings)
            if len(clip.views) != 2 or not all(view.frames for view in clip.views):
                raise CalibrationError(f"{path} has not two recorded views: name clips of a pair")
            sizes |= {view.source_size for view in clip.views}
            readers = {
                v.number: FrameCache(one) for v, one in zip(clip.views, decoders, strict=True)
            }
            with outside_sources(settings, clip.views) as sources:
                sightings.append(sighting_of(clip, settings, method, readers, sources))
            is_told = settings.offset_s is not None
            clocks.append(ON_TIME if is_told else clock_of(sightings[-1]))
    if len(sizes) > 1:
        told = ", ".join(f"{width}x{height}" for width, height in sorted(sizes))
        raise CalibrationError(f"pictures of several sizes ({told}) are not of one rig")
    found = calibrated_by_person(tuple(sightings), given.stature_m, given.fov_deg, tuple(clocks))
    rig = fitted(found.rig, sizes.pop(), "the calibration")
    return FoundByClips(rig, found.quality, found.clocks)
