"""Clip after clip: what is said of each, and how a bar hears how far one is."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import Any

import msgspec
import pytest
from rich.console import Console
from spoiling import copied, refilmed
from staging import RIG, report

from common.body.proportions import thesis_bdp
from common.bus.messages import Body, View, ViewerNumber
from common.config.settings import Settings
from common.video.clip_facts import Clip, ClipView, Meta
from common.video.pictures import Undecodable
from integrator.frame_numbers import FrameTimes
from runtime.offline import batch
from runtime.offline.batch import Asked, head_of, track_all
from runtime.offline.lockstep import Decoders, Tracked, track_clip
from runtime.store.clip_paths import ClipsFailed
from runtime.store.other_run import OtherRun
from runtime.store.recording import read_recording
from runtime.unfinished.work import Course
from tritrack.commands.clip_commands import line_of_runs

VIEWS: tuple[tuple[ViewerNumber, ...], ...] = ((1, 2), (1,))


@pytest.mark.slow
@pytest.mark.parametrize("views", VIEWS)
def test_a_clip_that_shows_nobody_is_tracked_and_that_is_said(
    clip: Path, tmp_path: Path, views: tuple[ViewerNumber, ...]
) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: 4 * film[:8])
    said = Console(file=StringIO(), width=500)
    track_all([folder], tmp_path / "runs", Asked(views=views), said)
    assert isinstance(said.file, StringIO)
    assert "warning: clip: nobody was seen" in said.file.getvalue()


@pytest.mark.slow
@pytest.mark.parametrize("views", VIEWS)
@pytest.mark.parametrize("calibrated", [True, False])
def test_a_bar_hears_of_every_frame_of_a_clip(
    clip: Path, tmp_path: Path, views: tuple[ViewerNumber, ...], calibrated: bool
) -> None:
    folder, shares = copied(clip, tmp_path / "clip"), list[float]()
    if not calibrated:
        (folder / "calibration.json").unlink()
    with Decoders() as decoders:
        done = track_clip(Settings(clip=str(folder)), decoders, views, course=Course(shares.append))
    assert shares == sorted(shares)
    assert (len(shares), shares[-1]) == (len(done.bodies), 1.0)


ADVICE = "the cameras are exchanged: change their order"


@pytest.mark.parametrize("advice", ["", ADVICE])
def test_a_calibration_that_is_not_believable_is_in_the_last_line_too(advice: str) -> None:
    clips: dict[str, dict[str, Any]] = {
        "walk": {"believed": 1.0, "trust": {"advice": advice}},
        "run": {"believed": 1.0},
    }
    line = line_of_runs(clips, Path("runs"))
    assert line.startswith("2 clips tracked, written to runs; believed in 100%")
    assert ("not believable: the calibration of walk" in line) == bool(advice)


def test_one_clip_is_one_clip() -> None:
    assert line_of_runs({"walk": {"believed": None}}, Path("r")) == "1 clip tracked, written to r"


class Tracker:
    """Tracks clips without pictures: what it is asked, and what it says of each."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.fails: dict[str, Exception] = {}
        self.facts: dict[str, Any] = {"warnings": ["it is dark"], "scale_source": "calibrated"}
        self.said: list[View | Body] = []
        self.watched: list[bool] = []
        monkeypatch.setattr(batch, "track_clip", self)
        monkeypatch.setattr(batch, "measured_before", lambda _: MEASURED)
        self.is_compiling = False
        monkeypatch.setattr(batch, "compiling_beside", self.compiling)

    @contextmanager
    def compiling(self) -> Iterator[None]:
        self.is_compiling = True
        yield
        self.is_compiling = False

    def __call__(
        self, settings: Settings, decoders: Decoders, views: Any, *, watch: Any, course: Course
    ) -> Tracked:
        name = Path(settings.clip).name
        self.asked.append((name, settings, views))
        assert self.is_compiling
        self.watched.append(watch is not None)
        if name in self.fails:
            raise self.fails[name]
        course.tell(0.5)
        bodies = [one for one in self.said if isinstance(one, Body)]
        reports = [one for one in self.said if isinstance(one, View)]
        if watch and self.said:
            watch.each({}, {2: reports[0], 1: reports[0]}, (bodies[0],))
            watch.begin()
            for body, one in zip(bodies, reports, strict=True):
                watch.each({}, {1: one}, (body,))
        return Tracked(CLIP, bodies, dict(self.facts))


MEASURED = thesis_bdp(1.62)
CLIP = Clip("walk", (ClipView(1, "cam1.avi", (64, 48), (32, 24), 15.0, 2),), 3, None, Meta())


def empty_body(frame: int) -> Body:
    return Body(
        frame=frame, captured_s=frame / 15, clock_s=frame / 15, status="empty", views="none"
    )


@pytest.fixture
def tracker(monkeypatch: pytest.MonkeyPatch) -> Tracker:
    return Tracker(monkeypatch)


def clip_folders(tmp_path: Path, *names: str) -> list[Path]:
    for name in names:
        (tmp_path / name).mkdir()
        (tmp_path / name / "cam1.avi").write_bytes(name.encode())
    return [tmp_path / name for name in names]


def said_by(call: Callable[[Console], object]) -> list[str]:
    console = Console(file=StringIO(), width=500)
    call(console)
    assert isinstance(console.file, StringIO)
    return console.file.getvalue().splitlines()


def test_all_that_is_asked_of_clips_reaches_each_of_them(tracker: Tracker, tmp_path: Path) -> None:
    folders, out = clip_folders(tmp_path, "a", "b"), tmp_path / "runs"
    given = Asked(mode="paper", size="96x80", views=(2,), trusted=True, offset_s=0.25)
    done: dict[str, Any] = {}
    said = said_by(lambda console: done.update(track_all(folders, out, given, console)))
    assert said == ["warning: a: it is dark", "warning: b: it is dark"]
    assert [(name, views) for name, _, views in tracker.asked] == [("a", (2,)), ("b", (2,))]
    for _, settings, _ in tracker.asked:
        assert (settings.mode, settings.size) == ("paper", "96x80")
        assert (settings.trust_calibration, settings.offset_s) == (True, 0.25)
    assert tracker.watched == [False, False]
    assert [*done] == ["clips"]
    facts = done["clips"]["b"]
    assert (facts["clip"], facts["believed"], facts["scale_source"]) == ("b", None, "calibrated")
    assert facts["run_of"] == {"command": "track", "footage": [str(folders[1] / "cam1.avi")]}
    assert json.loads((out / "b" / "summary.json").read_text())["clip"] == "b"
    track_all(folders[:1], out, Asked(), Console(quiet=True))
    _, settings, views = tracker.asked[-1]
    assert (settings.mode, settings.trust_calibration, views) == ("default", False, None)


def test_a_clock_that_was_set_is_said_of_its_clip(tracker: Tracker, tmp_path: Path) -> None:
    clock = {"state": "found", "applied_s": 0.2, "may_be_s": [], "may_be_on_time": True}
    tracker.facts = {"warnings": [], "clock": clock}
    folders = clip_folders(tmp_path, "a")
    said = said_by(lambda console: track_all(folders, tmp_path / "runs", Asked(), console))
    assert said == ["a: view 2 is +0.20 s late: its times were set back by that"]


def test_of_several_clips_one_that_fails_is_said_and_the_others_are_tracked(
    tracker: Tracker, tmp_path: Path
) -> None:
    folders = clip_folders(tmp_path, "a", "b", "c")
    tracker.fails["b"] = Undecodable("b has no picture")

    def track(console: Console) -> None:
        with pytest.raises(ClipsFailed, match=r"^1 of 3 clips could not be tracked$"):
            track_all(folders, tmp_path / "runs", Asked(), console)

    assert said_by(track)[1] == "error: b has no picture"
    assert sorted(path.name for path in (tmp_path / "runs").iterdir() if path.name != "b") == [
        "a",
        "c",
    ]
    with pytest.raises(Undecodable):
        track_all(folders[1:2], tmp_path / "runs", Asked(), Console(quiet=True))


def test_the_run_of_another_clip_is_written_over_by_force_alone(
    tracker: Tracker, tmp_path: Path
) -> None:
    (there,) = clip_folders(tmp_path, "a")
    (tmp_path / "other").mkdir()
    (same_name,) = clip_folders(tmp_path / "other", "a")
    out, quiet = tmp_path / "runs", Console(quiet=True)
    track_all([there], out, Asked(), quiet)
    with pytest.raises(OtherRun, match=r"tritrack track of .*cam1\.avi"):
        track_all([same_name], out, Asked(), quiet)
    assert len(tracker.asked) == 1
    track_all([same_name], out, Asked(force=True), quiet)
    assert len(tracker.asked) == 2


def test_a_run_that_is_over_is_not_tracked_again_where_it_is_resumed(
    tracker: Tracker, tmp_path: Path
) -> None:
    folders, out = clip_folders(tmp_path, "a"), tmp_path / "runs"
    quiet = Console(quiet=True)
    track_all(folders, out, Asked(), quiet)
    done = track_all(folders, out, Asked(resume=True), quiet)
    assert (len(tracker.asked), done["clips"]["a"]["clip"]) == (1, "a")
    track_all(folders, out, Asked(resume=True, views=(1,)), quiet)
    assert len(tracker.asked) == 2, "of other views"


def test_what_is_recorded_is_what_was_said_since_the_clip_was_begun_anew(
    tracker: Tracker, tmp_path: Path
) -> None:
    """The period is of every third of 15 frames a second; the body was measured before."""
    tracker.said = [report(1, frame=0), empty_body(0), report(1, frame=3), empty_body(3)]
    folders, out = clip_folders(tmp_path, "walk"), tmp_path / "runs"
    track_all(folders, out, Asked(record=True), Console(quiet=True))
    assert tracker.watched == [True]
    kept = read_recording(out / "walk")
    assert [one.frame for one in kept.reports[0]] == [0, 3]
    assert kept.reports[1] == []
    assert [body.frame for body in kept.bodies] == [0, 3]
    assert kept.head.body == MEASURED
    assert (kept.head.name, kept.head.scale_source) == ("walk", "calibrated")


def test_a_run_of_which_no_viewer_spoke_says_that_nothing_is_recorded(
    tracker: Tracker, tmp_path: Path
) -> None:
    folders, out = clip_folders(tmp_path, "walk"), tmp_path / "runs"
    said = said_by(lambda console: track_all(folders, out, Asked(record=True), console))
    assert said[1:] == [
        "warning: walk: nothing was recorded: one camera without a calibration is followed in "
        "passes over the whole film; follow it again instead"
    ]
    assert not (out / "walk" / "recording.mcap").exists()


def test_the_head_of_a_recording_tells_the_clip_as_it_was_looked_at() -> None:
    settings = Settings(mode="paper")
    head = head_of(CLIP, settings, "person", by_person=True)
    assert (head.name, head.settings, head.period_s) == ("walk", settings, 3 / 15)
    assert (head.alone, head.rig, head.body) == (True, None, None)
    assert (head.scale_source, head.by_person) == ("person", True)
    assert head.times == FrameTimes(3 / 15, 3)
    second = msgspec.structs.replace(CLIP.views[0], number=2, fps=30.0)
    rig = msgspec.structs.replace(RIG, cameras=RIG.cameras[1:])
    both = msgspec.structs.replace(CLIP, views=(*CLIP.views, second), rig=RIG, body=MEASURED)
    head = head_of(both, settings)
    assert (head.alone, head.rig, head.body, head.by_person) == (False, RIG, MEASURED, False)
    assert (head.period_s, head.scale_source) == (3 / 15, None), "by view 1's rate"
    alone = msgspec.structs.replace(CLIP, views=(second,), rig=rig)
    head = head_of(alone, settings)
    assert (head.period_s, head.times) == (3 / 30, None)
    assert head.rig is not None
    assert head.rig.cameras == (RIG.cameras[1],) * 2
