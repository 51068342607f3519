"""A film of one camera in two passes: its silhouettes and how tall who stands is, then its bodies.

What the thesis learns from all of a film, the background (3.1.2) and the scale (3.1.5), is known
before the first body; from there on the steps are those of a live run.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.proportions import thesis_bdp
from common.bus.message_codec import unpack
from common.bus.messages import Body, Guide, Report, ViewerNumber
from common.config import Settings
from common.method import METHODS, Method
from common.notes.notes import Notes, held
from common.raster.silhouette_report import with_silhouette
from common.rig.camera import PAPER_ROTATIONS, Camera, Rig
from common.video.clip_facts import Clip, shortfall
from common.video.clip_sources import ClipError
from common.video.decoding import Decoder
from common.video.frame_cache import Reader, Reel
from integrator import merge
from integrator.merge_state import ScaleSource, State
from integrator.opening_posture import Opening
from integrator.pairing import Pair
from integrator.rig.assumed_rig import assumed_camera
from integrator.single.sight import Annotations
from viewer import track
from viewer.background.background import Background, learn
from viewer.background.background_source import FilmBackground
from viewer.capture import recorded
from viewer.stick.standing_height import standing_of, standing_rows

MOST_FRAMES: Final = 50_000
"""Silhouettes are kept until the standing height is known, some 10 kB each."""
MOST_COVERED: Final = 0.5
"""Share of the picture that no person covers in most frames; a camera that moves does."""
FITS: Final = 0.6
"""S from which a pose fits its silhouette."""
MOSTLY: Final = 0.5
"""Where fewer of the poses fit, that is said."""

Watch = Callable[[int, int], object]
"""Hears how many frames were looked at or drawn, and of how many; 0: that is not known."""


class Followed(NamedTuple):
    """What one camera gave."""

    bodies: list[Body]
    reports: list[Report]
    rate_hz: float
    turn: NDArray[np.float64]
    """World to camera, (3, 3)."""
    clip: Clip | None
    """None of a sequence of masks, likewise `background`."""
    background: Background | None
    facts: dict[str, Any]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the working picture."""
        return self.reports[0].width, self.reports[0].height

    def to_camera(self, joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Joints with x to the right of the picture, y up, z to the camera."""
        return joints_m @ self.turn.T * (1.0, -1.0, -1.0)


class FilmFacts(NamedTuple):
    """What the second pass needs beside the silhouettes."""

    settings: Settings
    number: ViewerNumber
    period_s: float
    camera: Camera | None
    """Calibrated, at the working size; None: one is assumed."""
    notes: Notes = Notes()
    scale: float = 1.0
    """Pixels of the working picture in one of the video."""

    @property
    def method(self) -> Method:
        """What is done beyond the print."""
        return METHODS[self.settings.mode]


def follow_clip(
    clip: Clip,
    settings: Settings,
    background: FilmBackground,
    decoder: Decoder,
    notes: Notes = Notes(),
    watch: Watch = lambda *_: None,
) -> Followed:
    """Track a clip of one view whose background is known.

    Raises:
        ClipError: When it is too long, or its camera moves.
        DecoderDied: When the video broke the decoder.
    """
    began = time.perf_counter()
    view, reel = clip.views[0], Reel(decoder)
    camera = clip.rig.cameras[0] if clip.rig is not None else None
    scale = view.size[0] / view.source_size[0]
    film = FilmFacts(settings, view.number, clip.every / view.fps, camera, notes, scale)
    reports = silhouettes_of(clip, background, film, reel, watch)
    seen = time.perf_counter()
    bodies = bodies_of(reports, film)
    done = time.perf_counter()
    odd = (background.odd, shortfall(view, reel.came), doubtful(bodies))
    facts = {
        "clip": clip.name,
        "performer": clip.meta.performer,
        "posture_meant": clip.meta.posture,
        **_times(len(bodies), silhouettes=seen - began, poses=done - seen),
        "scale_source": "assumed" if camera is None else "calibrated",
        "never_uncovered": round(float(background.background.uncertain.mean()), 4),
        "warnings": [*clip.warnings, *filter(None, odd)],
    }
    turn = np.array(PAPER_ROTATIONS[0] if camera is None else camera.R)
    return Followed(bodies, reports, 1 / film.period_s, turn, clip, background.background, facts)


def follow_masks(name: str, reports: list[Report], settings: Settings) -> Followed:
    """The same for silhouettes that were cut out before."""
    began, least_share = time.perf_counter(), settings.silhouette.min_height_share
    reports = [_or_nobody(report, least_share) for report in reports]
    period_s = reports[1].captured_s - reports[0].captured_s if len(reports) > 1 else 0.04
    bodies = bodies_of(reports, FilmFacts(settings, 1, period_s, None))
    facts = {
        "clip": name,
        **_times(len(bodies), poses=time.perf_counter() - began),
        "scale_source": "assumed",
        "warnings": list(filter(None, (doubtful(bodies),))),
    }
    return Followed(bodies, reports, 1 / period_s, np.array(PAPER_ROTATIONS[0]), None, None, facts)


def _or_nobody(report: Report, least_share: float) -> Report:
    """A report, or one of nobody where its silhouette is lower than a person is."""
    box = report.box
    if box is None or box.bottom + 1 - box.top >= least_share * report.height:
        return report
    nobody = np.zeros((report.height, report.width), np.bool_)
    return with_silhouette(report, nobody)


def silhouettes_of(
    clip: Clip,
    background: FilmBackground,
    film: FilmFacts,
    reader: Reader,
    watch: Watch = lambda *_: None,
) -> list[Report]:
    """The first pass: the silhouette of every frame.

    Raises:
        ClipError: When the clip is too long, or its camera moves.
        DecoderDied: When the video broke the decoder.
    """
    view = clip.views[0]
    learnt, patches = background.background, background.patches
    viewer = track.init(
        film.number, learnt, film.camera, film.settings, film.method, alone=True, patches=patches
    )
    reports: list[Report] = []
    for frame in recorded(view, clip.every, reader):
        if len(reports) >= MOST_FRAMES:
            raise ClipError(f"{view.source} has more than {MOST_FRAMES} frames: track parts of it")
        viewer, report, _ = track.look(viewer, frame, None)
        reports.append(report)
        watch(len(reports), 2 * view.frames)
    _refuse_a_moving_camera(reports, str(view.source))
    return reports


def bodies_of(reports: Sequence[Report], film: FilmFacts) -> list[Body]:
    """The second pass: the viewer tells more of each silhouette, the integrator lifts it."""
    if not reports:
        return []
    viewer, state = _begun(reports, film)
    guide: Guide | None = None
    bodies: list[Body] = []
    for report in reports:
        told = _annotations(film, report.frame)
        if guide is not None and told.orientation is not None:
            guide = msgspec.structs.replace(guide, stick=True)
        viewer, full = track.describe(viewer, report, unpack(report), guide)
        pair = Pair(full, None) if film.number == 1 else Pair(None, full)
        state, body, guide = merge.step(state, pair, told)
        bodies.append(body)
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
    viewer = track.init(
        film.number, learn([nothing]), camera, settings, film.method, alone=True, standing=standing
    )
    stature_m, opening = settings.body.stature_m, Opening()
    if camera is None:
        sole, tall = (size[1], size[1]) if standing is None else standing[:2]
        camera = assumed_camera(size, sole, tall, stature_m)
        opening = Opening(bdp=thesis_bdp(stature_m))
    rig = Rig(*size, (camera, camera))
    source: ScaleSource = "assumed" if film.camera is None else "calibrated"
    state = merge.init(
        rig, film.period_s, settings, film.method, alone=True, source=source, opening=opening
    )
    return viewer, state


def _annotations(film: FilmFacts, frame: int) -> Annotations:
    told = held(film.notes, frame)
    places = {name: (u * film.scale, v * film.scale) for name, (u, v) in told.joints_px.items()}
    return Annotations(told.orientation, told.depth, places)


def _times(frames: int, **spent_s: float) -> dict[str, Any]:
    """Seconds of each stage, and the rate, for the summary."""
    total_s = sum(spent_s.values())
    seconds = {name: round(value, 4) for name, value in spent_s.items()}
    return {
        "seconds": {**seconds, "all": round(total_s, 4)},
        "frames_a_second": round(frames / max(total_s, 1e-9), 1),
    }


def doubtful(bodies: Sequence[Body]) -> str:
    """What is odd where no frame shows anybody, or few poses fit what they show; "" otherwise."""
    scores = [max(body.score) for body in bodies if body.joints_m]
    if not scores:
        return "nobody was seen: the person must move, and be a sixth of the picture high at least"
    fit = float(np.mean(np.array(scores) >= FITS))
    if fit >= MOSTLY:
        return ""
    return (
        f"only {fit:.0%} of the poses fit their silhouettes: the camera or its light may move, or "
        "what is outlined in the overlay is not one person"
    )


def _refuse_a_moving_camera(reports: Sequence[Report], source: str) -> None:
    areas = [report.area_px / (report.width * report.height) for report in reports if report.box]
    if areas and np.median(areas) > MOST_COVERED:
        raise ClipError(
            f"{source}: most of the picture changes, so its camera moves or its light does: only "
            "videos of a camera that stands still can be tracked"
        )
