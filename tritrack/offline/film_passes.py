"""The two passes over one camera's film: its silhouettes, then its bodies.

What the thesis learns from all of a film, the background (3.1.2) and the scale (3.1.5), is known
before the first body; from there on the steps are those of a live run.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.body.proportions import thesis_bdp
from common.bus.messages import Body, Guide, Report, ScaleSource, ViewerNumber
from common.config import Settings
from common.method import Method
from common.notes.notes import Notes, held
from common.raster.silhouette_report import unpack
from common.rig.camera import Camera, Rig
from common.video.clip_facts import Clip
from common.video.clip_sources import ClipError
from common.video.frame_cache import Reader
from integrator import merge, merge_state
from integrator.merge_state import Start, State
from integrator.opening_posture import Opening
from integrator.pairing import Pair
from integrator.rig.assumed_rig import assumed_camera
from integrator.single.sight import Annotations
from tritrack.offline.film_smoothing import calmed
from tritrack.offline.frame_pairs import share_of
from tritrack.terminal import Tell
from viewer import track
from viewer.background.background import learn
from viewer.capture import recorded
from viewer.landmarks.outside_source import OutsideSource
from viewer.room.background_source import FilmBackground
from viewer.stick.standing_height import standing_of, standing_rows

MOST_FRAMES: Final = 50_000
"""Silhouettes are kept until the standing height is known, some 10 kB each."""
MOST_COVERED: Final = 0.5
"""Share of the picture that no person covers in most frames; a camera that moves does."""


class FilmFacts(NamedTuple):
    """What both passes need to know of a film."""

    settings: Settings
    method: Method
    """What is done beyond the print."""
    number: ViewerNumber
    period_s: float
    camera: Camera | None
    """Calibrated, at the working size; None: one is assumed."""
    notes: Notes = Notes()
    scale: float = 1.0
    """Pixels of the working picture in one of the video."""


def silhouettes_of(
    clip: Clip,
    background: FilmBackground,
    film: FilmFacts,
    reader: Reader,
    source: OutsideSource | None = None,
    tell: Tell = lambda _: None,
) -> list[Report]:
    """The first pass: the silhouette and the landmarks of every frame.

    Raises:
        ClipError: When the clip is too long, or its camera moves.
        DecoderDied: When the video broke the decoder.
    """
    view = clip.views[0]
    viewer = track.init(_setup(film), background.background, patches=background.patches)
    reports: list[Report] = []
    for frame in recorded(view, clip.every, reader, source):
        if len(reports) >= MOST_FRAMES:
            raise ClipError(f"{view.source} has more than {MOST_FRAMES} frames: track parts of it")
        viewer, report, _ = track.look(viewer, frame, None)
        reports.append(report)
        tell(share_of(clip, {view.number: frame}))
    _refuse_a_moving_camera(reports, str(view.source))
    return reports


def bodies_of(
    reports: Sequence[Report], film: FilmFacts, tell: Tell = lambda _: None
) -> list[Body]:
    """The second pass: the viewer tells more of each silhouette, the integrator lifts it."""
    if not reports:
        return []
    viewer, state = _begun(reports, film)
    guide: Guide | None = None
    bodies: list[Body] = []
    for report in reports:
        annotations = _annotations(film, report.frame)
        if guide is not None and annotations.orientation is not None:
            guide = msgspec.structs.replace(guide, stick=True)
        viewer, full = track.describe(viewer, report, unpack(report), guide)
        pair = Pair(full, None) if film.number == 1 else Pair(None, full)
        state, body, guide = merge.step(state, pair, annotations)
        bodies.append(body)
        tell(len(bodies) / len(reports))
    if film.method.film_smoothing and state.rig is not None:
        return calmed(bodies, state.rig, film.notes)
    return bodies


def _begun(reports: Sequence[Report], film: FilmFacts) -> tuple[track.State, State]:
    """A viewer and an integrator that know what the first pass tells of the scale (T20)."""
    settings, camera = film.settings, film.camera
    size = (reports[0].width, reports[0].height)
    standing = standing_of(
        [standing_rows(unpack(report)) for report in reports if report.box is not None],
        [not report.cut for report in reports if report.box is not None],
    )
    nothing = np.zeros((size[1], size[0], 3), np.uint8)
    viewer = track.init(_setup(film), learn([nothing]), standing=standing)
    stature_m, opening = settings.body.stature_m, Opening()
    if camera is None:
        sole_row, tall_px = float(size[1]), float(size[1])
        if standing is not None:
            sole_row, tall_px = standing.sole_row, standing.tall_px
        camera = assumed_camera(size, sole_row, tall_px, stature_m)
        opening = Opening(bdp=thesis_bdp(stature_m))
    rig = Rig(*size, (camera, camera))
    source: ScaleSource = "assumed" if film.camera is None else "calibrated"
    state = merge_state.init(
        rig, film.period_s, settings, film.method, Start(True, source, opening)
    )
    return viewer, state


def _setup(film: FilmFacts) -> track.Setup:
    return track.Setup(film.number, film.camera, film.settings, film.method, alone=True)


def _annotations(film: FilmFacts, frame: int) -> Annotations:
    note = held(film.notes, frame)
    places = {name: (u * film.scale, v * film.scale) for name, (u, v) in note.joints_px.items()}
    return Annotations(note.orientation, note.depth, places)


def _refuse_a_moving_camera(reports: Sequence[Report], source: str) -> None:
    areas = [report.area_px / (report.width * report.height) for report in reports if report.box]
    if areas and np.median(areas) > MOST_COVERED:
        raise ClipError(
            f"{source}: most of the picture changes, so its camera moves or its light does: only "
            "videos of a camera that stands still can be tracked"
        )
