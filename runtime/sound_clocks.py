"""How late each view is by the sound of its video, where the videos have one."""

from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from common.bus.messages import ViewerNumber
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.sound.sound_of_video import RATE_HZ, can_hear, sound_of
from common.sound.sound_offset import delay_of
from common.video.clip_facts import Clip, set_back
from common.video.clip_sources import Offsets, offsets_of
from common.video.pictures import is_recorded

MOST_S: Final = 120.0
"""Largest delay that is looked for, seconds."""


class ByEar(NamedTuple):
    """A clip whose views are set back by what their sounds tell."""

    clip: Clip
    settings: Settings
    """With these delays as if the user had given them: nothing else is searched for."""
    late_s: Offsets
    """The delays, by camera number."""


def by_ear(clip: Clip, settings: Settings) -> ByEar:
    """Set the views of a recorded clip back by their sounds' delays.

    A camera whose delay the user gives keeps that; one whose sound is silent, repeats itself or has
    nothing to do with the first camera's is left to the person's motion.
    """
    late_s = _heard(clip, offsets_of(settings))
    if not late_s:
        return ByEar(clip, settings, {})
    by_s = [late_s.get(view.number, 0.0) for view in clip.views[1:]]
    return ByEar(set_back(clip, by_s), _with_offsets(clip, settings, late_s), late_s)


def heard_words(name: str, late_s: Offsets) -> list[str]:
    """What is said of a clip's delays by ear."""
    return [
        f"{name}: view {number} is {late:+.2f} s late: its times were set back by that, as the "
        "sound tells"
        for number, late in late_s.items()
    ]


def _heard(clip: Clip, given: Offsets) -> dict[ViewerNumber, float]:
    first, *others = clip.views
    asked = [view for view in others if view.number not in given]
    if not asked or not can_hear() or not all(is_recorded(v.source) for v in clip.views):
        return {}
    sound = sound_of(Path(str(first.source)))
    if sound is None:
        return {}
    found = {}
    for view in asked:
        own = sound_of(Path(str(view.source)))
        told = None if own is None else delay_of(sound, own, RATE_HZ, MOST_S)
        if told is not None and told.is_clear:
            found[view.number] = round(told.late_s, 4) + 0.0
    return found


def _with_offsets(clip: Clip, settings: Settings, late_s: Offsets) -> Settings:
    cameras = dict(settings.cameras)
    for view in clip.views:
        if view.number in late_s:
            own = cameras.get(view.name, CameraSettings())
            cameras[view.name] = msgspec.structs.replace(own, offset_s=late_s[view.number])
    return msgspec.structs.replace(settings, cameras=cameras)
