"""The live steps in one process, in lock-step: deterministic, as fast as possible."""

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from typing import NamedTuple

import msgspec

from calibration.tracks.camera_clocks import Clocks
from calibration.tracks.lateness import Clock
from common.body.body import Bdp
from common.bus.messages import MOST_VIEWS, Body, ScaleSource, ViewerNumber
from common.config.settings import Settings
from common.method import METHODS, Method
from common.npz_file import Facts
from common.video.clip_facts import (
    Clip,
    clip_summary,
    set_back,
    shortfall,
    unread_facts,
    uprights_of,
    whole_rig,
)
from common.video.clip_sources import Offsets, offsets_of
from common.video.clips import open_clip
from common.video.decoding import Decoder
from integrator import diagnostics, merge_state
from integrator.frame_numbers import frame_times
from integrator.measuring import opening_posture
from integrator.merge_state import Start
from integrator.people import recognition
from runtime.moved_facts import moved_facts
from runtime.odd_view import odd_camera_facts, odd_camera_of, odd_camera_warnings
from runtime.offline.frame_pairs import openings
from runtime.offline.opening_clip import body_of
from runtime.offline.performance import (
    STAGE,
    LockstepState,
    Performance,
    Prepared,
    Watch,
    performed,
)
from runtime.offline.rig_check import (
    Witness,
    clock_facts,
    clocks_seen,
    doubted,
    doubts,
    late_by,
    trust_facts,
)
from runtime.offline.rig_from_person import (
    Looked,
    by_person,
    calibration_facts,
    turned_back,
)
from runtime.offline.video_tracking import Heard, VideoInput, follow_clip, unseen
from runtime.sound_clocks import by_ear
from runtime.steps.frame_cache import FrameCache
from runtime.steps.method_cameras import (
    refuse_everyone_unmeasured,
    refuse_too_many,
    refuse_uncalibrated,
)
from runtime.steps.together import viewer_of
from runtime.unfinished.work import Course
from viewer import track
from viewer.landmark_step import open_networks
from viewer.landmarks.landmark_sources import Sources, oddities, outside_sources
from viewer.room.background_source import VideoBackground, opening_of_view


class Tracked(NamedTuple):
    """The result of tracking a clip."""

    clip: Clip
    bodies: Sequence[Body]
    facts: Facts
    """For the summary: seconds of each stage, scale_source, warnings."""


class Decoders:
    """One decoder per view, reused over many clips: starting a child takes longer than a clip."""

    def __init__(self) -> None:
        """None started yet."""
        self._doors = ExitStack()
        self.of: dict[ViewerNumber, Decoder] = {
            number: self._doors.enter_context(Decoder()) for number in range(1, MOST_VIEWS + 1)
        }

    def __enter__(self) -> "Decoders":
        """Nothing to do before the first clip."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the children."""
        self._doors.close()


class _Job(NamedTuple):
    """A request to track a clip."""

    settings: Settings
    method: Method
    decoders: Decoders
    sources: Sources
    watch: Watch | None
    course: Course
    heard: Offsets
    """Delays that the videos' sounds tell."""


class _Followed(NamedTuple):
    """A tracked clip."""

    ready: Prepared
    done: Performance
    witness: Witness


def track_clip(
    settings: Settings,
    decoders: Decoders,
    views: tuple[ViewerNumber, ...] | None = None,
    watch: Watch | None = None,
    method: Method | None = None,
    course: Course = Course(),
) -> Tracked:
    """Track one clip from its videos to its bodies; `watch` receives every instant.

    Args:
        settings: The run's settings.
        decoders: Read the videos.
        views: The cameras to use; None: all of the clip.
        watch: Receives every instant of a clip whose scale is known before.
        method: Replaces that of the settings' mode.
        course: Receives the progress, and stores the results.

    Raises:
        ClipError: When the clip cannot be used.
        DecoderDied: When a video crashed the decoder.
        SettingsError: When the source of landmarks cannot be used.
    """
    began = time.perf_counter()
    clip, settings, heard = by_ear(open_clip(settings, decoders.of[1], views), settings)
    method = method or METHODS[settings.mode]
    alone = len(clip.views) == 1
    refuse_too_many(clip, method)
    if alone and (method.stick_lifting or (method.proposals and clip.rig is None)):
        refuse_everyone_unmeasured(clip, settings)
        return _in_two_passes(clip, settings, method, decoders, course)
    with outside_sources(settings, clip.views) as sources:
        job = _Job(settings, method, decoders, sources, watch, course, heard)
        looked = _as_left(by_person(clip, settings, method, decoders.of, sources), course)
        refuse_uncalibrated(looked.clip, looked.warning)
        refuse_everyone_unmeasured(looked.clip, settings, looked.warning)
        followed = _followed(looked, job, began)
        clocks = clocks_seen(looked.clip, followed.witness)
        corrected = _corrected(looked, job, followed, clocks)
        if corrected is not looked:
            _begin_anew(job)
            followed = _followed(corrected, job, began)
            clocks = clocks_seen(corrected.clip, followed.witness)
        return _told(corrected, job, followed, clocks)


def _corrected(looked: Looked, job: _Job, followed: _Followed, clocks: Clocks) -> Looked:
    """With late views set back, and a camera turned back that contradicts all others."""
    late_s = late_by(looked.clip, clocks, offsets_of(job.settings))
    if looked.found is None and looked.odd is None and not job.settings.trust_calibration:
        everyone = followed.witness.sightings(looked.clip)
        looked = turned_back(looked, odd_camera_of(looked.clip, everyone, clocks))
    if looked.clocks or not any(late_s):
        return looked
    return looked._replace(clip=set_back(looked.clip, late_s), clocks=clocks)


def _as_left(looked: Looked, course: Course) -> Looked:
    """With the clock and the rig of an interrupted run that was being tracked again."""
    left = course.work.resumed(STAGE, LockstepState)
    if left is None:
        return looked
    looked = turned_back(looked, left.odd_camera)
    views = zip(looked.clip.views[1:], left.late_s, strict=True)
    late_s = [late - view.late_s for view, late in views]
    if not any(late_s):
        return looked
    clocks = tuple(Clock(late) for late in late_s)
    return looked._replace(clip=set_back(looked.clip, late_s), clocks=clocks)


def _begin_anew(job: _Job) -> None:
    job.course.work.restart()
    if job.watch:
        job.watch.begin()


def _followed(looked: Looked, job: _Job, began: float) -> _Followed:
    """All instants of a clip."""
    ready, witness = _prepared(looked, job.settings, job.method, job.decoders, began), Witness()
    done = performed(ready, job.sources, witness, job.watch, job.course)
    return _Followed(ready, done, witness)


def _told(looked: Looked, job: _Job, followed: _Followed, clocks: Clocks) -> Tracked:
    """The result, with the rig and the clocks as now known."""
    clip, settings, (ready, done, witness) = looked.clip, job.settings, followed
    trust = trust_facts(
        clip,
        witness,
        clocks,
        insisted=settings.trust_calibration,
        different_people=any(done.integrator.room.same.left_out),
    )
    facts = _facts(ready, done, job.sources) | calibration_facts(looked) | trust
    facts |= odd_camera_facts(clip, looked.odd)
    given = offsets_of(settings)
    facts |= moved_facts(done.bodies) | clock_facts(clip, looked.clocks or clocks, given, job.heard)
    facts["warnings"] += [*odd_camera_warnings(facts), *doubts(facts)]
    return Tracked(clip, doubted(done.bodies, clip, clocks, given), facts)


def _in_two_passes(
    clip: Clip, settings: Settings, method: Method, decoders: Decoders, course: Course
) -> Tracked:
    """Track one camera in passes: the scale needs the whole clip, or the thesis's method is
    used."""
    view = clip.views[0]
    frame_cache = FrameCache(decoders.of[view.number], due=view.frames)
    opening = opening_of_view(view, settings.silhouette, frame_cache)
    film = VideoInput(clip, VideoBackground(opening.background, [], opening.odd))
    heard = Heard(course.tell, work=course.work)
    followed = follow_clip(film, settings, method, frame_cache, heard)
    return Tracked(clip, followed.bodies, followed.facts)


def _prepared(
    looked: Looked, settings: Settings, method: Method, decoders: Decoders, began: float
) -> Prepared:
    """Viewers with their backgrounds and an integrator with the rig."""
    clip, odd = looked.clip, [looked.warning] if looked.warning else []
    rig, alone = whole_rig(clip), len(clip.views) == 1
    known = body_of(settings, lambda own: track_clip(own, decoders).bodies)
    frame_caches = {
        view.number: FrameCache(decoders.of[view.number], due=view.frames) for view in clip.views
    }
    viewers: dict[ViewerNumber, track.State] = {}
    with ThreadPoolExecutor(1) as beside:
        if method.landmarks:
            beside.submit(open_networks, settings)
        learnt = openings(clip, settings.silhouette, frame_caches)
    for view, opens in zip(clip.views, learnt, strict=True):
        odd += [opens.odd] if opens.odd else []
        viewers[view.number] = viewer_of(
            view, clip, settings, method, opens.background, opens.somebody
        )
    period_s = clip.every / clip.views[0].fps
    opening = opening_posture.init(known)
    source: ScaleSource | None = "person" if looked.found else None
    start = Start(alone, source, opening, frame_times(clip), uprights=uprights_of(clip))
    integrator = merge_state.init(rig, period_s, settings, method, start)
    state, seconds = recognition.State(integrator), time.perf_counter() - began
    return Prepared(clip, frame_caches, viewers, state, odd, seconds, looked.odd)


def _facts(ready: Prepared, done: Performance, sources: Sources) -> Facts:
    """For the summary: the input, the time taken, warnings."""
    clip, acts = ready.clip, ready.clip.meta.acts
    endings = [(view, ready.frame_caches[view.number].ending) for view in clip.views]
    cut_off = (shortfall(view, ending) for view, ending in endings)
    seen_odd = (*cut_off, unseen(done.bodies), *oddities(sources))
    odd = [*clip.warnings, *ready.odd, *filter(None, seen_odd)]
    followed_s = done.seconds["following"]
    seconds = {"preparation": ready.seconds, **done.seconds, "all": ready.seconds + followed_s}
    return {
        **clip_summary(clip),
        **({"acts": msgspec.to_builtins(acts)} if acts else {}),
        **unread_facts(endings),
        "seconds": {name: round(value, 4) for name, value in seconds.items()},
        "frames_a_second": round(len(done.bodies) / followed_s, 1),
        "scale_source": done.integrator.room.scale_source,
        "warnings": [*odd, *diagnostics.warnings(done.noticed, done.integrator.room), *done.news],
    }


def measured_before(settings: Settings) -> Bdp | None:
    """The person's body from the opening clip in the settings, if any.

    Raises:
        SettingsError, ClipError, DecoderDied: As `body_of` and `track_clip`.
    """
    with Decoders() as decoders:
        return body_of(settings, lambda own: track_clip(own, decoders).bodies)
