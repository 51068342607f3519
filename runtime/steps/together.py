"""The steps of one instant, in lock-step: its viewers, then the integrator."""

from collections.abc import Callable, Iterable, Mapping
from itertools import repeat
from typing import Any

from common.body.observation import Landmarks
from common.bus.instant import instant_of
from common.bus.messages import Guide, View, ViewerNumber, place_in_rig
from common.config.settings import Settings
from common.method import Method
from common.video.clip_facts import Clip, ClipView, whole_rig
from integrator.live_rig.live_calibration import LiveCalibration
from integrator.people import recognition, several
from integrator.people.lived_instant import Merged
from viewer import track
from viewer.background.background import Background
from viewer.captured_frame import CapturedFrame

Viewers = Mapping[ViewerNumber, track.State]
Reports = Mapping[int, View]
Each = Callable[..., Iterable[Any]]
"""`map`, or a parallel version."""


def viewer_of(
    view: ClipView,
    clip: Clip,
    settings: Settings,
    method: Method,
    background: Background,
    somebody: Landmarks | None = None,
) -> track.State:
    """A viewer of a clip with its background.

    Args:
        view: The camera's view.
        clip: With the rig.
        settings: The run's settings.
        method: The departures from the print.
        background: The picture without people.
        somebody: The person in the first frame, where the whole clip was examined before.
    """
    rig = whole_rig(clip)
    camera = None if rig is None else rig.cameras[place_in_rig(view.number)]
    setup = track.Setup(view.number, camera, settings, method, len(clip.views) == 1)
    return track.init(setup, background, somebody=somebody)


def looked(
    viewers: Viewers,
    frames: Mapping[ViewerNumber, CapturedFrame],
    guide: Guide | None,
    each: Each = map,
) -> tuple[dict[ViewerNumber, track.State], dict[int, View]]:
    """Each viewer's state after its frame, and its report.

    Args:
        viewers: State of each.
        frames: Frames of the instant; a viewer without one keeps its state.
        guide: The integrator's guide after the instant before; None at the start.
        each: Calls the viewers' steps.
    """
    before = [viewers[number] for number in frames]
    seen = dict(zip(frames, each(track.step, before, frames.values(), repeat(guide)), strict=True))
    states = {**viewers, **{number: state for number, (state, _) in seen.items()}}
    return states, {number: report for number, (_, report) in seen.items()}


def joined(
    integrator: recognition.State, reports: Reports, calibration: LiveCalibration
) -> tuple[recognition.State, Merged]:
    """The integrator's state after the reports of an instant, the bodies and the guide.

    Args:
        integrator: Its state.
        reports: At least one.
        calibration: Receives them, and may change the rig.
    """
    instant = instant_of(reports, len(integrator.room.frames))
    state, merged = several.step(integrator, instant)
    calibration.heard(merged.of_first)
    return several.with_room(state, calibration.changed(state.room)), merged
