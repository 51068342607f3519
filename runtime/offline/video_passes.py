"""The two passes over one camera's video: its silhouettes, then its bodies.

The thesis learns the background (3.1.2) and the scale (3.1.5) from the whole video, before the
first body; after that the steps are those of a live run.
"""

import time
from collections.abc import Sequence
from itertools import islice
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from calibration.tracks.joint_tracks import is_upright
from common.body.observation import Observation
from common.body.proportions import thesis_bdp
from common.bus.instant import Instant
from common.bus.messages import Body, Guide, ScaleSource, View, ViewerNumber
from common.config.settings import Settings
from common.method import Method
from common.notes.notes import Notes, held
from common.raster.silhouette_report import mask_of, unpack
from common.rig.camera import Camera, Rig
from common.rig.upright_camera import as_worked_on
from common.video.clip_facts import Clip
from common.video.clip_sources import ClipError
from common.video.pictures import Ending, Reader
from integrator import merge, merge_state
from integrator.measuring.known_body import Opening, Unknown, Unmeasured
from integrator.merge_state import Start, State
from integrator.rig.tilted_camera import LEVEL, TILTS_DEG, camera_of_sights
from integrator.single.sight import Annotations
from runtime.offline.frame_pairs import share_of
from runtime.offline.video_smoothing import calmed
from runtime.unfinished.unfinished_run import BODIES
from runtime.unfinished.work import Course
from viewer import track
from viewer.background.background import learn
from viewer.capture import recorded
from viewer.landmarks.outside_source import OutsideSource
from viewer.room.background_source import VideoBackground
from viewer.stick.standing_height import standing_of, standing_rows

CUTTING, POSING = "silhouettes", "poses"
"""Names of the passes, for resuming."""
REPORTS, CALM = "reports", "calm"
MOST_COVERED: Final = 0.5
"""Largest share of the picture that a person covers in most frames; a moving camera exceeds it."""


class VideoFacts(NamedTuple):
    """Inputs of both passes."""

    settings: Settings
    method: Method
    """The departures from the print."""
    number: ViewerNumber
    period_s: float
    camera: Camera | None
    """Calibrated, at the working size; None: a camera is assumed."""
    notes: Notes = Notes()
    scale: float = 1.0
    """Pixels of the working picture per pixel of the video."""


class Cutting(NamedTuple):
    """Progress of the first pass."""

    viewer: track.State
    start: int = 0
    """The next frame."""
    spent_s: float = 0.0


class FirstPass(NamedTuple):
    """Results of the first pass."""

    odd: tuple[str, ...] = ()
    """Warnings about the video."""
    spent_s: float = 0.0
    ending: Ending = Ending()
    """How far it could be read."""


class Lifted(NamedTuple):
    """Results of the second pass."""

    bodies: Sequence[Body]
    camera: Camera | None
    """The camera by which bodies are lifted; None without frames."""


class Stand(NamedTuple):
    """A silhouette of a frame, reduced to its rows."""

    rows: tuple[float, float]
    """From `standing_rows`."""
    whole: bool
    upright: bool


class Posing(NamedTuple):
    """Progress of the second pass."""

    viewer: track.State
    integrator: State
    first: FirstPass
    guide: Guide | None = None
    spent_s: float = 0.0


def silhouettes_of(
    clip: Clip,
    background: VideoBackground,
    film: VideoFacts,
    reader: Reader,
    source: OutsideSource | None = None,
    course: Course = Course(),
) -> Sequence[View]:
    """The first pass: silhouette and landmarks of every frame, from where it was interrupted.

    Raises:
        ClipError: When the camera moves.
        DecoderDied: When the video crashed the decoder.
    """
    view, work, began = clip.views[0], course.work, time.perf_counter()
    at = work.resumed(CUTTING, Cutting) or Cutting(
        track.init(_setup(film), background.background, patches=background.patches)
    )
    before_s, reports = at.spent_s, work.messages(REPORTS)
    for frame in recorded(view, clip.every, reader, source, at.start):
        viewer, report, _ = track.look(at.viewer, frame, None)
        reports.append(report)
        at = Cutting(viewer, frame.index + 1, before_s + time.perf_counter() - began)
        course.tell(share_of(clip, {view.number: frame}))
        if work.due:
            work.save(CUTTING, at)
    _refuse_a_moving_camera(reports, str(view.source))
    return reports


def bodies_of(
    reports: Sequence[View],
    film: VideoFacts,
    course: Course = Course(),
    first: FirstPass = FirstPass(),
) -> Lifted:
    """The second pass: the viewer measures each silhouette, the integrator lifts it.

    Args:
        reports: Results of the first pass.
        film: Inputs of both passes.
        course: Receives the progress, and stores the bodies.
        first: Stored with the progress.
    """
    work, began = course.work, time.perf_counter()
    bodies = work.messages(BODIES)
    if not reports:
        return Lifted(bodies, None)
    at = work.resumed(POSING, Posing) or Posing(*_begun(reports, film), first)
    before_s = at.spent_s
    for report in islice(reports, len(bodies), None):
        at, body = _posed(at, report, film)
        bodies.append(body)
        course.tell(len(bodies) / len(reports))
        if work.due:
            work.save(POSING, at._replace(spent_s=before_s + time.perf_counter() - began))
    rig = at.integrator.rig
    assert rig is not None
    if film.method.film_smoothing:
        kept, uprights = work.messages(CALM), at.integrator.uprights
        return Lifted(calmed(bodies, rig, film.notes, kept, uprights), rig.cameras[0])
    return Lifted(bodies, rig.cameras[0])


def _posed(at: Posing, report: View, film: VideoFacts) -> tuple[Posing, Body]:
    """One frame of the second pass."""
    annotations, guide = _annotations(film, report), at.guide
    if guide is not None and annotations.orientation is not None:
        guide = msgspec.structs.replace(guide, stick=True)
    viewer, full = track.describe(at.viewer, report, mask_of(report), guide)
    instant = Instant((full, None)) if film.number == 1 else Instant((None, full))
    state, body, guide = merge.step(at.integrator, instant, annotations)
    return at._replace(viewer=viewer, integrator=state, guide=guide), body


def _begun(reports: Sequence[View], film: VideoFacts) -> tuple[track.State, State]:
    """A viewer and an integrator that know the first pass's scale (T20)."""
    settings, camera = film.settings, film.camera
    size = (reports[0].width, reports[0].height)
    stands = [_stand_of(report.person) for report in reports if report.person is not None]
    standing = standing_of([one.rows for one in stands], [one.whole for one in stands])
    nothing = np.zeros((size[1], size[0], 3), np.uint8)
    viewer = track.init(_setup(film), learn([nothing]), standing=standing)
    stature_m = settings.body.stature_m
    opening: Opening = Unknown()
    if camera is None:
        tilts_deg = LEVEL if film.method.stick_lifting else TILTS_DEG
        camera = camera_of_sights(size, _sights(stands, size), stature_m, tilts_deg)
        opening = Unmeasured(thesis_bdp(stature_m))
    rig = Rig(*size, (camera, camera))
    source: ScaleSource = "assumed" if film.camera is None else "calibrated"
    state = merge_state.init(
        rig, film.period_s, settings, film.method, Start(True, source, opening)
    )
    return viewer, state


def _stand_of(person: Observation) -> Stand:
    """A video has many reports: each is released after use."""
    shown = person.landmarks
    upright = shown is not None and is_upright(shown)
    return Stand(standing_rows(unpack(person)), not person.cut, upright)


def _sights(stands: Sequence[Stand], size: tuple[int, int]) -> NDArray[np.float64]:
    """Rows of the silhouettes that determine a camera, (n, 2): whole ones of an upright person,
    or else all."""
    whole = [one for one in stands if one.whole] or stands
    upright = [one for one in whole if one.upright] or whole
    return np.array([one.rows for one in upright] or [(0.0, float(size[1]))])


def _setup(film: VideoFacts) -> track.Setup:
    return track.Setup(film.number, film.camera, film.settings, film.method, alone=True)


def _annotations(film: VideoFacts, report: View) -> Annotations:
    """The user's inputs for a frame, in the pixels of its report."""
    note = held(film.notes, report.frame)
    filed = film.scale * np.array([*note.joints_px.values()]).reshape(-1, 2)
    places = as_worked_on(filed, report.upright).tolist()
    placed = {name: (u, v) for name, (u, v) in zip(note.joints_px, places, strict=True)}
    return Annotations(note.orientation, note.depth, placed)


def _refuse_a_moving_camera(reports: Sequence[View], source: str) -> None:
    people = [report.person for report in reports if report.person is not None]
    areas = [person.area_px / (person.width * person.height) for person in people]
    if areas and np.median(areas) > MOST_COVERED:
        raise ClipError(
            f"{source}: most of the picture changes, so its camera moves or its light does: only "
            "videos of a camera that stands still can be tracked"
        )
