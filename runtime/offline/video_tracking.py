"""A video of one camera, tracked in two passes: its bodies and warnings (T1)."""

import time
from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.bus.messages import Body, View
from common.config.settings import Settings
from common.method import METHODS, Method
from common.notes.notes import Notes
from common.npz_file import Facts
from common.rig.camera import PAPER_ROTATIONS, Camera
from common.video.clip_facts import Clip, clip_summary, shortfall, unread_facts
from common.video.pictures import Reader
from runtime.offline.video_passes import (
    CUTTING,
    POSING,
    REPORTS,
    Cutting,
    FirstPass,
    Posing,
    VideoFacts,
    bodies_of,
    silhouettes_of,
)
from runtime.store.runs import NO_PERSON_SEEN
from runtime.terminal import Tell
from runtime.unfinished.work import Course, InMemory, Work
from viewer.background.background import Background
from viewer.landmarks.landmark_sources import oddities, outside_sources
from viewer.room.background_source import VideoBackground

FITS: Final = 0.6
"""S from which on a pose fits its silhouette."""
MOSTLY: Final = 0.5
"""Share of fitting poses below which there is a warning."""


class Followed(NamedTuple):
    """The result of one camera."""

    bodies: Sequence[Body]
    reports: Sequence[View]
    period_s: float
    """Time between frames, where the rate is constant."""
    camera: Camera | None
    """The camera by which bodies were lifted, calibrated or assumed; None without frames."""
    clip: Clip | None
    """None for a sequence of masks, likewise `background`."""
    background: Background | None
    facts: Facts

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the working picture."""
        return self.reports[0].width, self.reports[0].height

    def to_camera(self, joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Joints with x to the right of the picture, y up, z along the floor to the camera."""
        towards = -self.turn[2] * (1.0, 0.0, 1.0)
        towards /= max(float(np.linalg.norm(towards)), 1e-9)
        up = np.array([0.0, 1.0, 0.0])
        return joints_m @ np.stack([np.cross(up, towards), up, towards]).T

    @property
    def turn(self) -> NDArray[np.float64]:
        """World to camera, (3, 3)."""
        return np.array(PAPER_ROTATIONS[0] if self.camera is None else self.camera.R)


class VideoInput(NamedTuple):
    """The input: a clip of one view, and what is known of it."""

    clip: Clip
    background: VideoBackground
    notes: Notes = Notes()
    """The user's inputs."""


class Heard(NamedTuple):
    """Receives the progress of each pass, and stores its results."""

    silhouettes: Tell = lambda _: None
    poses: Tell = lambda _: None
    work: Work = InMemory()


def follow_clip(
    film: VideoInput, settings: Settings, method: Method, reader: Reader, heard: Heard = Heard()
) -> Followed:
    """Track a clip of one view with a known background.

    Raises:
        ClipError: When the camera moves.
        DecoderDied: When the video crashed the decoder.
        SettingsError: When the source of landmarks cannot be used.
    """
    clip, background, notes = film
    view = clip.views[0]
    camera = clip.rig.cameras[0] if clip.rig is not None else None
    scale = view.filed_size[0] / view.source_size[0]
    period_s = clip.every / view.fps
    known = VideoFacts(settings, method, view.number, period_s, camera, notes, scale)
    left = heard.work.resumed(POSING, Posing)
    if left is None:
        reports, first = _looked_through(film, known, reader, heard)
    else:
        reports, first = heard.work.messages(REPORTS), left.first
    seen = time.perf_counter()
    lifted = bodies_of(reports, known, Course(heard.poses, heard.work), first)
    bodies = lifted.bodies
    posing_s = time.perf_counter() - seen + (left.spent_s if left else 0.0)
    odd = (background.odd, *first.odd, doubtful(bodies))
    facts = {
        **clip_summary(clip),
        **_times(len(bodies), silhouettes=first.spent_s, poses=posing_s),
        "scale_source": "assumed" if camera is None else "calibrated",
        **_camera_facts(lifted.camera if camera is None else None),
        **unread_facts([(view, first.ending)]),
        "never_uncovered": round(float(background.background.uncertain.mean()), 4),
        "warnings": [*clip.warnings, *filter(None, odd)],
    }
    known_room = background.background
    return Followed(bodies, reports, period_s, lifted.camera, clip, known_room, facts)


def _camera_facts(assumed: Camera | None) -> Facts:
    """The assumed camera, for the summary."""
    return {} if assumed is None else {"camera": msgspec.to_builtins(assumed)}


def _looked_through(
    film: VideoInput, known: VideoFacts, reader: Reader, heard: Heard
) -> tuple[Sequence[View], FirstPass]:
    """The first pass, and its results."""
    clip, work, began = film.clip, heard.work, time.perf_counter()
    view, begun = clip.views[0], work.resumed(CUTTING, Cutting)
    with outside_sources(known.settings, clip.views) as sources:
        outside, course = sources.get(view.number), Course(heard.silhouettes, work)
        reports = silhouettes_of(clip, film.background, known, reader, outside, course)
        odd = (shortfall(view, reader.ending), *oddities(sources))
    spent_s = time.perf_counter() - began + (begun.spent_s if begun else 0.0)
    return reports, FirstPass(odd, spent_s, reader.ending)


def follow_masks(
    name: str, reports: list[View], settings: Settings, tell: Tell = lambda _: None
) -> Followed:
    """The same for silhouettes from a file."""
    began, least_share = time.perf_counter(), settings.silhouette.min_height_share
    reports = [_without_low_regions(report, least_share) for report in reports]
    period_s = reports[1].captured_s - reports[0].captured_s if len(reports) > 1 else 0.04
    film = VideoFacts(settings, METHODS[settings.mode], 1, period_s, None)
    bodies, camera = bodies_of(reports, film, Course(tell))
    facts = {
        "clip": name,
        **_times(len(bodies), poses=time.perf_counter() - began),
        "scale_source": "assumed",
        **_camera_facts(camera),
        "warnings": list(filter(None, (doubtful(bodies),))),
    }
    return Followed(bodies, reports, period_s, camera, None, None, facts)


def _without_low_regions(report: View, least_share: float) -> View:
    """A report; without a person where its silhouette is lower than one."""
    person = report.person
    if person is None or person.box.bottom + 1 - person.box.top >= least_share * report.height:
        return report
    return msgspec.structs.replace(report, people=())


def _times(frames: int, **spent_s: float) -> Facts:
    """Seconds of each stage, and the frame rate, for the summary."""
    total_s = sum(spent_s.values())
    seconds = {name: round(value, 4) for name, value in spent_s.items()}
    return {
        "seconds": {**seconds, "all": round(total_s, 4)},
        "frames_a_second": round(frames / max(total_s, 1e-9), 1),
    }


def unseen(bodies: Sequence[Body]) -> str:
    """The warning where no frame shows a person; "" otherwise."""
    return "" if any(body.joints_m for body in bodies) else NO_PERSON_SEEN


def doubtful(bodies: Sequence[Body]) -> str:
    """The warning where no frame shows a person, or few poses fit; "" otherwise."""
    scores = [max(body.score) for body in bodies if body.joints_m]
    if not scores:
        return unseen(bodies)
    fit = float(np.mean(np.array(scores) >= FITS))
    if fit >= MOSTLY:
        return ""
    return (
        f"only {fit:.0%} of the poses fit their silhouettes: the camera or its light may move, or "
        "what is outlined in the overlay is not one person"
    )
