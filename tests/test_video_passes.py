"""One camera's silhouettes made into bodies: the scale of all of a film, then the live steps."""

import itertools
import sys
from collections.abc import Iterator, Sequence
from copy import copy
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from staging import RIG, person_of

from common.body.body import JOINT_NAMES
from common.body.proportions import thesis_bdp
from common.bus.instant import Instant
from common.bus.messages import Body, Guide, View, ViewerNumber
from common.config.part_settings import BodySettings
from common.config.settings import Settings
from common.method import METHODS, Method, Mode
from common.notes.notes import Note, Notes
from common.raster.silhouette_report import silhouette_view
from common.rig.camera import Camera, Rig
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.clip_sources import ClipError
from runtime.offline import video_passes
from runtime.offline.video_passes import (
    CUTTING,
    POSING,
    REPORTS,
    Cutting,
    FirstPass,
    Posing,
    Stand,
    VideoFacts,
    bodies_of,
    silhouettes_of,
)
from runtime.unfinished.unfinished_run import BODIES
from runtime.unfinished.work import Course
from viewer.captured_frame import CapturedFrame
from viewer.room.background_source import VideoBackground
from viewer.track import Setup

SIZE = (160, 120)
FEW = 10
"""Matches of a frame whose outline is enough; a stick body takes hundreds."""


@pytest.fixture(scope="module")
def silhouettes(clip: Path) -> list[View]:
    """True silhouettes of somebody who raises an arm."""
    with np.load(clip / "truth.npz") as truth:
        masks = np.unpackbits(truth["mask_cam1"], axis=2)[:, :, : SIZE[0]].astype(np.bool_)
    return [silhouette_view(1, mask, n, n / 15) for n, mask in enumerate(masks)]


def posed(reports: list[View], mode: Mode = "default", notes: Notes = Notes()) -> list[Body]:
    film = VideoFacts(Settings(mode=mode), METHODS[mode], 1, 1 / 15, None, notes)
    return list(bodies_of(reports, film).bodies)


def test_who_is_known_by_the_silhouette_is_not_fitted(silhouettes: list[View], clip: Path) -> None:
    """Shows 7: the search of the stick body took half of the time. Shows 3 holds all the same."""
    seen = [body for body in posed(silhouettes) if body.joints_m]
    assert len(seen) == sum(report.person is not None for report in silhouettes)
    assert np.mean([body.matches <= FEW for body in seen]) > 0.8
    with np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        at = {name: truth["joints2d_cam1"][:, names.index(name)] for name in JOINT_NAMES}
    for name in ("head_top", "r_wrist", "l_ankle"):
        shown = np.array([body.joints_px[0][JOINT_NAMES.index(name)] for body in seen])
        true = at[name][[body.frame for body in seen]]
        tall = np.ptp([at["head_top"][-1][1], at["l_ankle"][-1][1]])
        assert np.linalg.norm(shown - true, axis=1).mean() < 0.06 * tall


def test_the_thesis_fits_every_frame(silhouettes: list[View]) -> None:
    """T10 to T18: as printed, nothing is proposed."""
    some = silhouettes[20:23]
    assert min(body.matches for body in posed(some, "thesis")) > 100


def test_who_is_told_to_face_elsewhere_is_fitted(silhouettes: list[View]) -> None:
    """T22: what is proposed faces the camera; the user's word goes before it."""
    some = silhouettes[20:24]
    notes = Notes(note=(Note(some[2].frame, orientation="left"),))
    found = posed(some, notes=notes)
    assert [body.matches <= FEW for body in found] == [True, True, False, False]
    assert [body.lifting.orientation for body in found[2:] if body.lifting] == ["left", "left"]


def test_who_left_is_met_afresh(silhouettes: list[View]) -> None:
    """P9: a frame without anybody has no pose, and the next one owes it nothing."""
    empty = silhouette_view(1, np.zeros((SIZE[1], SIZE[0]), np.bool_), 2, 2 / 15)
    some = [silhouettes[20], silhouettes[21], empty, silhouettes[20], silhouettes[21]]
    bodies = posed(some)
    assert [bool(body.joints_m) for body in bodies] == [True, True, False, True, True]
    assert np.allclose(bodies[3].joints_m, bodies[0].joints_m, rtol=0.0, atol=1e-12)


class Lent(Sequence[View]):
    """Reports that are read one by one, as from a file, and how many were alive at once."""

    def __init__(self, reports: list[View]) -> None:
        self.reports = reports
        self.kept: list[int] = []

    def __len__(self) -> int:
        return len(self.reports)

    def __getitem__(self, index: Any) -> Any:
        return copy(self.reports[index])

    def __iter__(self) -> Iterator[View]:
        for report in self.reports:
            lent = copy(report)
            yield lent
            self.kept.append(sys.getrefcount(lent))


def test_a_film_of_any_length_is_not_held_in_memory(silhouettes: list[View]) -> None:
    let_go, passed = Lent(silhouettes[20:24]), Lent(silhouettes[20:24])
    for _ in let_go:
        pass
    film = VideoFacts(Settings(), METHODS["default"], 1, 1 / 15, None, Notes())
    bodies_of(passed, film)
    assert len(passed.kept) >= len(let_go.kept)
    assert max(passed.kept) <= max(let_go.kept)


CLIP = Clip("film", (ClipView(2, "a.mp4", SIZE, SIZE, 15.0, 10),), 1, None, Meta())
THESIS = METHODS["thesis"]


def film_of(**more: Any) -> VideoFacts:
    return VideoFacts(Settings(), METHODS["default"], 1, 1 / 15, None)._replace(**more)


class Left:
    """Work that was left, is due at every second frame, and keeps what it is handed."""

    def __init__(self, **left: Any) -> None:
        self.left, self.kept = left, dict[str, list[Any]]()
        self.saved: list[tuple[str, Any]] = []
        self.asked = 0

    @property
    def due(self) -> bool:
        self.asked += 1
        return self.asked % 2 == 0

    def messages(self, name: str) -> list[Any]:
        return self.kept.setdefault(name, [])

    def resumed(self, stage: str, kind: type[Any]) -> Any:
        found = self.left.get(stage)
        return found if isinstance(found, kind) else None

    def save(self, stage: str, state: object) -> None:
        self.saved.append((stage, state))

    def restart(self) -> None:
        raise AssertionError("no pass begins anew")


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """A first pass without pictures: a viewer counts what it sees; a clock ticks seconds."""
    asked: list[Any] = []
    ticks = itertools.count(10.0)

    def frames(*given: Any) -> Iterator[CapturedFrame]:
        asked.append(given)
        for n in range(given[-1], 5):
            yield CapturedFrame(n, n / 15, n / 15, np.zeros((0, 0, 3), np.uint8))

    def look(state: int, frame: CapturedFrame, guide: None) -> tuple[int, View, None]:
        mask = np.zeros((4, 4), np.bool_)
        mask.flat[: frame.index + 5] = True
        return state + 1, silhouette_view(2, mask, frame.index, frame.captured_s), None

    def init(*given: Any, **more: Any) -> int:
        asked.append((*given, more))
        return 100

    monkeypatch.setattr(video_passes, "recorded", frames)
    monkeypatch.setattr("viewer.track.look", look)
    monkeypatch.setattr("viewer.track.init", init)
    monkeypatch.setattr("runtime.offline.video_passes.time.perf_counter", lambda: next(ticks))
    return asked


BEHIND: Any = VideoBackground("room", ["patch"], "")  # type: ignore[arg-type,list-item]


def test_the_first_pass_looks_at_every_frame_and_saves_where_it_is(looks: list[Any]) -> None:
    """Silhouettes of 5, 6, 7, 8 and 9 of 16 pixels: no more than half of most pictures."""
    work, shares, film = Left(), list[float](), film_of(number=2)
    reader: Any = object()
    source: Any = object()
    reports = silhouettes_of(CLIP, BEHIND, film, reader, source, Course(shares.append, work))
    setup = Setup(2, None, film.settings, film.method, alone=True)
    assert looks == [
        (setup, "room", {"patches": ["patch"]}),
        (CLIP.views[0], 1, reader, source, 0),
    ]
    assert [one.frame for one in reports] == [0, 1, 2, 3, 4]
    assert work.kept[REPORTS] is reports
    assert shares == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
    saved = [(CUTTING, (102, 2, 2.0)), (CUTTING, (104, 4, 4.0))]
    assert work.saved == saved


def test_the_first_pass_goes_on_from_where_it_was_left(looks: list[Any]) -> None:
    left: Any = Cutting(7, 3, 40.0)  # type: ignore[arg-type]
    work = Left(**{CUTTING: left})
    work.messages(REPORTS).append(silhouette_view(2, np.eye(4, dtype=np.bool_), 2))
    reports = silhouettes_of(CLIP, BEHIND, film_of(), object(), None, Course(work=work))  # type: ignore[arg-type]
    assert [asked[-1] for asked in looks] == [3], "no new viewer"
    assert [one.frame for one in reports] == [2, 3, 4]
    saved = [(CUTTING, (9, 5, 42.0))]
    assert work.saved == saved


@pytest.mark.parametrize(("pixels", "refused"), [((9, 9, 8), True), ((9, 8, 8), False)])
def test_a_film_in_which_most_of_the_picture_changes_is_refused(
    pixels: tuple[int, ...], refused: bool
) -> None:
    """Of 16 pixels; frames that show nothing do not count."""
    reports = []
    for count in (*pixels, 0, 0, 0):
        mask = np.zeros((2, 8), np.bool_)
        mask.flat[:count] = True
        reports.append(silhouette_view(1, mask))
    if refused:
        with pytest.raises(ClipError, match=r"^a\.mp4: most of the picture changes, so its camera"):
            video_passes._refuse_a_moving_camera(reports, "a.mp4")
    else:
        video_passes._refuse_a_moving_camera(reports, "a.mp4")
    video_passes._refuse_a_moving_camera(reports[3:], "a.mp4")


class Poses:
    """A second pass without people: what is calmed, and a clock that ticks seconds."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calmed: list[Any] = []
        ticks = itertools.count(10.0)
        self.state: Any = SimpleNamespace(rig=RIG, uprights=("one", "two"))
        monkeypatch.setattr(video_passes, "_begun", lambda *_: ("viewer", self.state))
        monkeypatch.setattr(video_passes, "_posed", self.posed)
        monkeypatch.setattr(video_passes, "calmed", self.calm)
        monkeypatch.setattr("runtime.offline.video_passes.time.perf_counter", lambda: next(ticks))

    def posed(self, at: Posing, report: View, _: VideoFacts) -> tuple[Posing, Any]:
        return at._replace(guide=report.frame), f"body {report.frame}"  # type: ignore[arg-type]

    def calm(self, *given: Any) -> list[str]:
        self.calmed.append(given)
        return ["calm"]


def told(count: int) -> list[View]:
    return [silhouette_view(1, np.ones((4, 4), np.bool_), 10 + n) for n in range(count)]


def test_the_second_pass_keeps_each_body_and_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is saved tells of the first pass too; the film is calmed where the method says so."""
    poses, work, shares = Poses(monkeypatch), Left(), list[float]()
    first, notes = FirstPass(("dark",), 3.0), Notes(note=(Note(4, orientation="left"),))
    film = film_of(notes=notes)
    assert film.method.film_smoothing
    done = bodies_of(told(4), film, Course(shares.append, work), first)
    assert work.kept[BODIES] == ["body 10", "body 11", "body 12", "body 13"]
    assert shares == [0.25, 0.5, 0.75, 1.0]
    saved: list[Any] = [
        (POSING, Posing("viewer", poses.state, first, 11, 1.0)),  # type: ignore[arg-type]
        (POSING, Posing("viewer", poses.state, first, 13, 2.0)),  # type: ignore[arg-type]
    ]
    assert work.saved == saved
    assert [*done] == [["calm"], RIG.cameras[0]]
    assert poses.calmed == [(work.kept[BODIES], RIG, notes, work.kept["calm"], ("one", "two"))]
    method = msgspec.structs.replace(film.method, film_smoothing=False)
    plain = bodies_of(told(2), film._replace(method=method))
    assert [*plain] == [["body 10", "body 11"], RIG.cameras[0]]
    assert [*bodies_of([], film)] == [[], None]
    assert len(poses.calmed) == 1


def test_the_second_pass_goes_on_from_where_it_was_left(monkeypatch: pytest.MonkeyPatch) -> None:
    poses = Poses(monkeypatch)
    left: Any = Posing("left", poses.state, FirstPass(), None, 50.0)  # type: ignore[arg-type]
    work = Left(**{POSING: left})
    work.messages(BODIES).extend(["body 10", "body 11"])
    bodies_of(told(4), film_of(), Course(work=work))
    assert work.kept[BODIES] == ["body 10", "body 11", "body 12", "body 13"]
    saved: list[Any] = [(POSING, Posing("left", poses.state, FirstPass(), 13, 51.0))]  # type: ignore[arg-type]
    assert work.saved == saved


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("oriented", [True, False])
def test_each_frame_is_told_by_its_own_viewer_with_what_the_user_says(
    monkeypatch: pytest.MonkeyPatch, number: ViewerNumber, oriented: bool
) -> None:
    """An orientation asks for the stick body; places of the video are halved."""
    asked: list[Any] = []
    given: dict[str, Any] = {"orientation": "left"} if oriented else {}
    notes = Notes(note=(Note(3, joints_px={"l_wrist": (40.0, 30.0)}, **given),))
    film = film_of(number=number, notes=notes, scale=0.5)
    guide = Guide(frame=4, captured_s=0.3, clock_s=0.3, frames=(4, 4))

    def describe(*of: Any) -> tuple[str, View]:
        asked.append(of)
        return "viewer on", of[1]

    def step(*of: Any) -> tuple[str, str, str]:
        asked.append(of)
        return "integrator on", "body", "guide on"

    monkeypatch.setattr("viewer.track.describe", describe)
    monkeypatch.setattr("integrator.merge.step", step)
    report = told(1)[0]
    at: Any = Posing("viewer", "integrator", FirstPass(), guide, 2.0)  # type: ignore[arg-type]
    now, body = video_passes._posed(at, report, film)
    going: Any = Posing("viewer on", "integrator on", FirstPass(), "guide on", 2.0)  # type: ignore[arg-type]
    assert [now, body] == [going, "body"]
    (viewer, seen, mask, by), (state, pair, annotations) = asked
    assert (viewer, seen, mask.all(), state) == ("viewer", report, True, "integrator")
    assert by == msgspec.structs.replace(guide, stick=oriented)
    assert pair == (Instant((report, None)) if number == 1 else Instant((None, report)))
    assert annotations.orientation == ("left" if oriented else None)
    assert annotations.joints_px == {"l_wrist": (20.0, 15.0)}
    now, _ = video_passes._posed(at._replace(guide=None), report, film)
    assert asked[2][3] is None


def standing(top: int, bottom: int, cut: bool = False) -> View:
    """A silhouette as high as 160x120 has these rows."""
    mask = np.zeros((SIZE[1], SIZE[0]), np.bool_)
    mask[top:bottom, 0 if cut else 60 : 80] = True
    return silhouette_view(1, mask)


@pytest.mark.parametrize("method", [METHODS["default"], THESIS])
def test_the_scale_is_told_by_whole_silhouettes_of_all_of_the_film(
    monkeypatch: pytest.MonkeyPatch, method: Method
) -> None:
    """A calibrated film keeps its camera, an assumed one is level in the thesis alone."""
    asked: list[Any] = []
    camera = RIG.cameras[0]

    def camera_of_sights(*of: Any) -> Camera:
        asked.append(of)
        return camera

    monkeypatch.setattr(video_passes, "camera_of_sights", camera_of_sights)
    reports = [standing(10, 90), standing(12, 93, cut=True), standing(0, 0), standing(14, 96)]
    settings = Settings(body=BodySettings(stature_m=1.9))
    film = film_of(settings=settings, method=method, period_s=0.04)
    viewer, state = video_passes._begun(reports, film)
    ((size, sights, stature_m, tilts_deg),) = asked
    assert (size, stature_m) == (SIZE, 1.9)
    assert sights.tolist() == [[10.0, 90.0], [14.0, 96.0]]
    assert (len(tilts_deg) == 1) == (method is THESIS)
    assert state.rig == Rig(*SIZE, (camera, camera))
    assert (state.scale_source, state.alone) == ("assumed", True)
    assert state.person.body.bdp == thesis_bdp(1.9)
    assert viewer.setup == Setup(1, None, settings, method, alone=True)
    _, state = video_passes._begun(reports, film._replace(camera=RIG.cameras[1]))
    assert len(asked) == 1
    assert state.rig == Rig(*SIZE, (RIG.cameras[1],) * 2)
    assert (state.scale_source, state.person.body.bdp) == ("calibrated", None)


def test_where_all_are_cut_these_tell_the_camera_and_of_nobody_the_picture() -> None:
    cut = [video_passes._stand_of(person_of(standing(12, 93, cut=True)))]
    assert video_passes._sights(cut, SIZE).tolist() == [[12.0, 93.0]]
    assert video_passes._sights([], SIZE).tolist() == [[0.0, 120.0]]
    lies = Stand((50.0, 70.0), whole=True, upright=False)
    up = Stand((10.0, 90.0), whole=True, upright=True)
    up_but_cut = Stand((11.0, 91.0), whole=False, upright=True)
    assert video_passes._sights([lies, up, up_but_cut], SIZE).tolist() == [[10.0, 90.0]]
    assert video_passes._sights([lies, up_but_cut], SIZE).tolist() == [[50.0, 70.0]]
