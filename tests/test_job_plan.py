"""Which command follows from which files and wishes, and what is refused."""

from pathlib import Path

import msgspec
import pytest
from command_line import unknown_in

from animator.start.wishes import Compare, Export, Open, Report, Work
from tritrack.starting.job_plan import (
    Dropped,
    Known,
    Plan,
    PlanError,
    board_plan,
    free_name,
    name_of_files,
    planned,
    run_plan,
    tasks_of,
)
from tritrack.starting.wish_plans import demo_plan, live_plan

RUNS = Path("runs")
ONE = [Dropped(Path("up/1/dance.MP4"), 120)]
TWO = [Dropped(Path("up/1/walk_front.mp4"), 90), Dropped(Path("up/2/walk_side.avi"), 100)]
KNOWN = Known(RUNS, frozenset({"dance"}), frozenset({"room"}), records=True)


def test_one_video_is_followed_with_one_camera() -> None:
    plan = planned(Work(task="single"), ONE, Known(RUNS))
    assert plan.command == "tritrack single runs/.clips/dance/dance.mp4 --out runs"
    assert plan.placed == ((Path("up/1/dance.MP4"), RUNS / ".clips/dance/dance.mp4"),)
    assert (plan.run, plan.frames) == ("dance", 120)


def test_several_videos_become_a_clip_in_the_order_of_the_tray() -> None:
    plan = planned(Work(task="track", offset_s=-0.5), TWO, Known(RUNS))
    assert plan.command == (
        "tritrack track runs/.clips/walk --out runs --size 320x240 --offset -0.5"
    )
    assert [str(to) for _, to in plan.placed] == [
        "runs/.clips/walk/cam1.mp4",
        "runs/.clips/walk/cam2.avi",
    ]
    other = planned(Work(task="track"), TWO[::-1], Known(RUNS))
    assert [(a.name, b.name) for a, b in other.placed] == [
        ("walk_side.avi", "cam1.avi"),
        ("walk_front.mp4", "cam2.mp4"),
    ]


def test_a_calibration_goes_beside_the_clip_and_a_run_is_recorded_where_it_can_be() -> None:
    plan = planned(Work(task="track", calibration="room"), TWO, KNOWN)
    kept = RUNS / ".calibrations/room.json"
    assert plan.placed[-1] == (kept, RUNS / ".clips/walk/calibration.json")
    assert plan.arguments[-1] == "--record"


def test_everyone_is_followed_where_that_is_asked_for() -> None:
    assert "--people all" in planned(Work(task="track", everyone=True), TWO, KNOWN).command
    assert "--people" not in planned(Work(task="track"), TWO, KNOWN).command


def test_calibrating_keeps_what_the_command_says() -> None:
    person = planned(Work(task="person", stature_m=1.82), TWO, Known(RUNS))
    assert person.command == (
        "tritrack calibrate person runs/.clips/walk --stature 1.82 "
        "--out runs/.calibrations/walk.json"
    )
    assert person.report == RUNS / ".calibrations/walk.txt"
    assert person.run == ""
    board = planned(Work(task="board", name="hall", square_mm=39.5), TWO, Known(RUNS))
    assert board.command == (
        "tritrack calibrate board runs/.clips/hall/cam1.mp4 runs/.clips/hall/cam2.avi "
        "--square 39.5 --out runs/.calibrations/hall.json"
    )
    theirs = planned(Work(task="import"), [Dropped(Path("up/3/Calib.toml"))], Known(RUNS))
    assert theirs.command == (
        "tritrack calibrate import runs/.clips/Calib/Calib.toml --out runs/.calibrations/Calib.json"
    )


EVERY = (
    planned(Work(task="single"), ONE, KNOWN),
    planned(Work(task="track", offset_s=1.0, calibration="room", everyone=True), TWO, KNOWN),
    planned(Work(task="person"), TWO, KNOWN),
    planned(Work(task="board", square_mm=40.0), TWO, KNOWN),
    planned(Work(task="import"), [Dropped(Path("up/3/Calib.toml"))], KNOWN),
    planned(Work(task="poles"), TWO, KNOWN),
    planned(Work(task="markers"), TWO, KNOWN),
    board_plan(RUNS, "a4"),
    run_plan(Open("walk", "replay"), RUNS, 8081),
    run_plan(Open("walk", "retouch"), RUNS, 8081),
    run_plan(Export("walk", "bvh"), RUNS, 8081),
    run_plan(Report("walk"), RUNS, 8081),
    run_plan(Compare("walk", "walk_2"), RUNS, 8081),
    live_plan(RUNS / ".settings/live.toml", KNOWN, "live"),
    demo_plan(RUNS),
)


@pytest.mark.parametrize("plan", EVERY, ids=lambda plan: plan.title)
def test_every_plan_is_a_command_that_there_is(plan: Plan) -> None:
    assert unknown_in(list(plan.arguments)) == []


def test_two_runs_are_compared_by_their_folders() -> None:
    plan = run_plan(Compare("walk", "walk_2"), RUNS, 8081)
    assert plan.command == "tritrack compare runs/walk runs/walk_2"


def test_what_can_be_done_follows_from_what_was_dropped() -> None:
    assert tasks_of(1, 0) == ("single",)
    assert tasks_of(2, 0) == ("track", "person", "board", "poles", "markers")
    assert tasks_of(3, 0) == tasks_of(8, 0) == ("track", "person", "board")
    assert tasks_of(9, 0) == tasks_of(0, 0) == tasks_of(0, 2) == tasks_of(1, 1) == ()
    assert tasks_of(0, 1) == ("import",)


@pytest.mark.parametrize(
    ("stems", "name"),
    [
        (["dance"], "dance"),
        (["cam1", "cam2"], "clip"),
        (["walk_cam1", "walk_cam2"], "walk"),
        (["walk front", "walk side"], "walk"),
        (["GOPR0012", "MVI_77"], "GOPR0012"),
        (["tänze & më"], "t_nze_m"),
        (["..", "--"], "video"),
    ],
)
def test_a_clip_is_named_by_what_its_files_share(stems: list[str], name: str) -> None:
    assert name_of_files(stems) == name


def test_no_run_takes_the_place_of_another() -> None:
    assert free_name("dance", {"dance", "dance_2"}) == "dance_3"
    assert planned(Work(task="single"), ONE, KNOWN).run == "dance_2"
    assert len(free_name("x" * 60, {"x" * 60})) <= 60


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"name": "../etc"}, "letters, digits"),
        ({"name": ".hidden"}, "letters, digits"),
        ({"name": "--force"}, "letters, digits"),
        ({"name": "x" * 61}, "longer than 60"),
        ({"calibration": "../room"}, "choose one of the list"),
        ({"stature_m": 175.0}, "from 0.5 to 2.6, got 175"),
        ({"stature_m": float("nan")}, "from 0.5 to 2.6, got nan"),
        ({"square_mm": 0.0}, "from 1 to 1000, got 0"),
        ({"offset_s": 4000.0}, "from -3600 to 3600, got 4000"),
    ],
)
def test_what_no_command_would_take_is_refused_before(change: dict[str, object], says: str) -> None:
    wish = msgspec.structs.replace(Work(task="track"), **change)
    with pytest.raises(PlanError, match=says):
        planned(wish, TWO, KNOWN)
