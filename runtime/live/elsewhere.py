"""Cameras on other hosts: integrator and recognizer know them by the calibration alone."""

import msgspec

from common.config.settings import Settings
from common.rig.rig_file import CalibrationError, load_rig
from common.video.clip_facts import Clip, whole_rig
from common.video.clip_sources import ClipError, companions_folder, sources_of
from common.video.clips import find_calibration, open_clip
from common.video.decoding import Decoder
from common.video.pictures import Source, VideoInfo, is_camera


class Unopened(Decoder):
    """Takes a camera's facts from the calibration, as it may be attached to another host."""

    def __init__(self, camera: VideoInfo) -> None:
        """Facts of each camera."""
        super().__init__()
        self._camera = camera

    def probe(self, source: Source) -> VideoInfo:
        """The facts of a source; a file is opened, as usual."""
        return self._camera if is_camera(source) else super().probe(source)


def whole_clip(settings: Settings) -> Clip:
    """The clip of the settings, with a camera for each viewer where it is calibrated.

    Calibrated cameras are not opened: their pictures have the calibration's size, and come at `fps`
    of the settings, or of the calibration, or 15 a second.

    Raises:
        ClipError: When something is missing or inconsistent.
    """
    path = find_calibration(settings, companions_folder(settings, sources_of(settings)))
    try:
        rig = load_rig(path) if path else None
    except CalibrationError as error:
        raise ClipError(str(error)) from error
    if rig is None:
        return _with_all(open_clip(settings))
    fps = settings.fps or rig.fps or 0.0
    with Unopened(VideoInfo(rig.width, rig.height, fps, frames=0)) as decoder:
        return _with_all(open_clip(settings, decoder))


def _with_all(clip: Clip) -> Clip:
    return msgspec.structs.replace(clip, rig=whole_rig(clip))
