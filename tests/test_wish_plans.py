"""Wishes against what is there now: what is planned, and what is refused."""

import os
from dataclasses import replace
from pathlib import Path

import pytest

from animator.start.wishes import Compare, Export, Live, Open, Record, Report, Work
from common.config import config_file
from common.video.pictures import Source, VideoInfo
from tritrack.starting.job_plan import PlanError
from tritrack.starting.tray import Facts
from tritrack.starting.uploads import Upload
from tritrack.starting.wish_plans import There, plan_of

WALK = Facts(VideoInfo(width=640, height=480, fps=15.0, frames=150))


@pytest.fixture
def there(tmp_path: Path) -> There:
    """A run, a clip that is kept, a calibration, two dropped videos, three cameras."""
    for name in ("walk", ".clips/squat", ".calibrations"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "walk/poses.npz").write_bytes(b"")
    (tmp_path / ".calibrations/room.json").write_text("{}")
    files = [Upload(1, Path("a/cam1.avi"), 9, 9), Upload(2, Path("b/cam2.avi"), 9, 9)]
    sources: dict[str, Source] = {"video0": 0, "video2": 2, "file0": str(tmp_path / "cam.avi")}
    return There(tmp_path, files, {1: WALK, 2: WALK}, sources, frozenset({"clip"}))


def test_a_name_is_free_of_runs_clips_calibrations_and_jobs(there: There) -> None:
    assert plan_of(Work("track"), there).run == "clip_2"
    for name in ("walk", "squat", "room"):
        assert plan_of(Work("track", name=name), there).run == f"{name}_2"


def test_what_the_tray_does_not_offer_is_refused(there: There) -> None:
    with pytest.raises(PlanError, match="drop one video, or two to eight"):
        plan_of(Work("single"), there)
    with pytest.raises(PlanError, match="drop one video, or two to eight"):
        plan_of(Work("track"), there._replace(facts={1: WALK}))


def test_a_live_run_is_of_the_chosen_cameras_in_their_order(there: There) -> None:
    plan = plan_of(Live(("file0", "video2"), "room", pictures=True), there)
    settings = config_file.load(Path(plan.arguments[1]))
    assert [settings.cameras["cam1"].source, settings.cameras["cam2"].device] == [
        there.sources["file0"],
        2,
    ]
    assert settings.calibration == str((there.runs / ".calibrations/room.json").resolve())
    assert settings.page.port > 0
    assert plan.kind == "page"
    assert plan.needs == (there.runs / ".calibrations/room.json",)


@pytest.mark.parametrize(
    ("wish", "says"),
    [
        (Live(()), "choose one"),
        (Live(("video0", "video0")), "choose one"),
        (Live(("video0", "video7")), "look again"),
        (Live(("video0",), "../room"), "choose one of the list"),
        (Open("gone", "replay"), "no run 'gone' any more"),
        (Export("../walk", "bvh"), "no run"),
        (Export("walk", "exe"), "no format 'exe'"),
        (Export("walk", "--help"), "no format"),
        (Report(".clips"), "no run"),
        (Compare("walk", "gone"), "no run 'gone' any more"),
    ],
)
def test_what_is_not_there_is_refused(there: There, wish: Live, says: str) -> None:
    with pytest.raises(PlanError, match=says):
        plan_of(wish, there)
    assert not (there.runs / ".settings").exists()


def test_a_camera_whose_file_the_settings_cannot_name_is_refused(there: There) -> None:
    named = there._replace(sources={"file0": os.fsdecode(b"caf\xe9.avi")})
    with pytest.raises(PlanError, match="rename it"):
        plan_of(Live(("file0",)), named)


def test_a_recording_is_of_the_chosen_cameras_in_their_order(there: There) -> None:
    plan = plan_of(Record(("file0", "video2"), 9.5, "walk"), there)
    clip = there.runs / ".recorded/walk"
    cameras = ("--camera", str(there.sources["file0"]), "--camera", "2")
    assert plan.arguments == ("record", "--out", str(clip), *cameras, "--seconds", "9.5")
    assert (plan.records, plan.run, plan.kind) == (clip, "", "work")
    clip.mkdir(parents=True)
    assert plan_of(Record(("file0", "video2"), 9.5, "walk"), there).records == (
        there.runs / ".recorded/walk_2"
    )


@pytest.mark.parametrize(
    ("wish", "says"),
    [
        (Record(("video0",), 9.0), "choose two cameras or more"),
        (Record(("video0", "video9"), 9.0), "of those that are there"),
        (Record(("video0", "video2"), 0.5), "from 1 to 1200 seconds, got 0.5"),
        (Record(("video0", "video2"), float("nan")), "got nan"),
        (Record(("video0", "video2"), 9.0, "../walk"), "other signs than letters"),
    ],
)
def test_what_cannot_be_recorded_is_refused(there: There, wish: Record, says: str) -> None:
    with pytest.raises(PlanError, match=says):
        plan_of(wish, there)


def test_the_times_of_a_recording_go_with_its_videos_in_whatever_order(there: There) -> None:
    """Of files that share no clock, and of one that has no times, none are known."""
    first, second = (
        replace(file, times_s=times_s, recording="walk")
        for file, times_s in zip(there.files, ((0.0, 0.5), (0.25, 0.75)), strict=True)
    )
    for task in ("track", "person", "board"):
        plan = plan_of(Work(task), there._replace(files=[second, first]))
        assert plan.times_s == ((0.25, 0.75), (0.0, 0.5))
    for other in (replace(second, recording="run"), there.files[1]):
        plan = plan_of(Work("track"), there._replace(files=[first, other]))
        assert plan.times_s == ()
    assert plan_of(Work("track"), there).times_s == ()
