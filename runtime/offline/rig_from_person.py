"""A first pass over uncalibrated clips: their cameras, from the person who moves there."""

from collections.abc import Mapping
from typing import Final, NamedTuple

import msgspec
import numpy as np

from calibration.gate.odd_camera import OddCamera
from calibration.person.rig_quality import PersonCalibration
from calibration.tracks.camera_clocks import Clocks, clocks_of
from calibration.tracks.joint_tracks import JointTrack, Sightings
from calibration.tracks.lateness import LEAST_LATE, Clock
from calibration.tracks.one_of_several import person_tracks
from common.bus.messages import View, ViewerNumber
from common.config.settings import Settings
from common.method import Method
from common.npz_file import Facts
from common.rig.absurd_rig import nearly_one_view
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError, fitted, is_of_shape
from common.video.clip_facts import Clip, ClipView, set_back
from common.video.clip_sources import offsets_of
from common.video.pictures import Reader, Size
from runtime.odd_view import turned_clip
from runtime.offline.frame_pairs import instants, openings
from viewer import track
from viewer.landmarks.landmark_sources import Sources

ON_TIME: Final = Clock(0.0)
"""The clock of view 2 where the user gives its delay: it is on time after that."""
MOST_FRAMES: Final = 3_000
"""Number of a clip's first frames that are used."""
NOT_OF_ONE_SHAPE: Final = "not calibrated by the person: the views' pictures differ in shape"


class Looked(NamedTuple):
    """Results of the first pass."""

    clip: Clip
    """With the rig, if found, and with the clock of view 2 corrected."""
    found: PersonCalibration | None = None
    warning: str = ""
    clocks: Clocks = ()
    """Clocks of the views after the first, by their own times; none where they were not
    estimated."""
    odd: OddCamera | None = None
    """The camera that the clip's rig has turned back."""


def sightings_of(
    clip: Clip,
    settings: Settings,
    method: Method,
    readers: Mapping[ViewerNumber, Reader],
    sources: Sources,
) -> Sightings:
    """All views of the person in a clip without a rig, until a camera is moved, in pixels of the
    first view's pictures.

    Raises:
        DecoderDied: When a video crashed the decoder.
    """
    learnt = openings(clip, settings.silhouette, readers)
    viewers = {
        view.number: track.init(
            track.Setup(view.number, None, settings, method),
            opening.background,
            somebody=opening.somebody,
        )
        for view, opening in zip(clip.views, learnt, strict=True)
    }
    reports: dict[ViewerNumber, list[View]] = {view.number: [] for view in clip.views}
    for n, frames in enumerate(instants(clip, readers, sources)):
        for number, frame in frames.items():
            viewers[number], report, _ = track.look(viewers[number], frame, None)
            reports[number].append(report)
        is_moved = any(own[-1].shift is not None for own in reports.values() if own)
        if n + 1 == MOST_FRAMES or is_moved:
            break
    size = clip.views[0].size
    found = person_tracks([reports[view.number] for view in clip.views])
    views = zip(found, clip.views, strict=True)
    return Sightings(tuple(_in_size(track, view, size) for track, view in views), size)


def _in_size(track: JointTrack, view: ClipView, size: Size) -> JointTrack:
    """A view's landmarks in pixels of pictures of another size."""
    return track._replace(joints_px=track.joints_px * (np.array(size) / view.size))


def in_own_sizes(rig: Rig, views: tuple[ClipView, ...]) -> Rig:
    """The rig with each camera for the size of its own view's pictures."""
    cameras = tuple(
        fitted(rig, view.size, view.name).cameras[place] for place, view in enumerate(views)
    )
    return msgspec.structs.replace(rig, cameras=cameras)


def by_person(
    clip: Clip,
    settings: Settings,
    method: Method,
    readers: Mapping[ViewerNumber, Reader],
    sources: Sources,
) -> Looked:
    """A recorded clip of several views, with a rig from its person where it has none.

    It is unchanged where it has a rig, where the method uses no landmarks, where too little of a
    person is seen, and where the views' pictures differ in shape.
    """
    of_files = all(view.frames for view in clip.views)
    if clip.rig is not None or len(clip.views) < 2 or not of_files:
        return Looked(clip)
    if not (method.landmarks and method.proposals):
        return Looked(clip)
    if not all(is_of_shape(view.size, clip.views[0].size) for view in clip.views):
        return Looked(clip, None, NOT_OF_ONE_SHAPE)
    from calibration.person.many_calibration import calibrated_by_all  # as long as all else

    seen = sightings_of(clip, settings, method, readers, sources)
    clocks = believed_clocks(clip, settings, seen)
    try:
        found = calibrated_by_all((seen,), settings.body.stature_m, None, (clocks,))
    except CalibrationError as error:
        told = f"not calibrated by the person: {error}"
        late_s = tuple(clock.late_s for clock in clocks)
        return Looked(on_time(clip, clocks, late_s), None, told, clocks)
    rig = in_own_sizes(found.rig, clip.views)
    clip = on_time(msgspec.structs.replace(clip, rig=rig), clocks, found.late_s)
    return Looked(clip, found, nearly_one_view(found.rig), clocks)


def believed_clocks(clip: Clip, settings: Settings, seen: Sightings) -> Clocks:
    """The clocks of the views after the first: on time where the user gives all delays."""
    given = offsets_of(settings)
    if all(view.number in given for view in clip.views[1:]):
        return (ON_TIME,) * (len(clip.views) - 1)
    clocks = zip(clip.views[1:], clocks_of(seen), strict=True)
    return tuple(ON_TIME if view.number in given else clock for view, clock in clocks)


def on_time(clip: Clip, clocks: Clocks, late_s: tuple[float, ...]) -> Clip:
    """The clip with the times of each view set back by its delay, where that is found.

    Args:
        clip: A clip of several views.
        clocks: Clocks of the views after the first.
        late_s: Their delays by the rig in use.
    """
    by_s = [
        late if clock.is_found and abs(late) >= LEAST_LATE * clip.every / view.fps else 0.0
        for view, clock, late in zip(clip.views[1:], clocks, late_s, strict=True)
    ]
    return set_back(clip, by_s) if any(by_s) else clip


def turned_back(looked: Looked, odd: OddCamera | None) -> Looked:
    """With a camera of its rig turned back, where one is odd."""
    if odd is None:
        return looked
    return looked._replace(clip=turned_clip(looked.clip, odd), odd=odd)


def calibration_facts(looked: Looked) -> Facts:
    """For the summary: the calibration found, and its quality."""
    if looked.found is None:
        return {}
    rig, quality = (msgspec.to_builtins(part) for part in (looked.found.rig, looked.found.quality))
    return {"calibration": {**rig, "quality": quality}}
