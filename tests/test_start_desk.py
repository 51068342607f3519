"""What is behind the start page, without a server: it goes on whatever fails around it."""

import json
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import pytest
from spoiling import film_of, write_video
from waiting import until

from animator.page.wish_page import Told
from animator.start.sections import Tray
from animator.start.wishes import (
    Again,
    Begin,
    Chunk,
    Compare,
    Delete,
    Demo,
    Drop,
    Look,
    Record,
    Report,
    Take,
    Task,
    Watched,
    Wish,
    Work,
)
from tritrack.machine_cameras.camera_list import FoundCamera
from tritrack.starting import start_lists
from tritrack.starting.job_plan import Dropped, Known, Plan, kept_calibration, planned
from tritrack.starting.job_queue import Job, JobQueue
from tritrack.starting.start_desk import Given, StartDesk
from tritrack.starting.start_files import place

FRAMES = {"one": 45, "two": 48}
"""Lengths of the videos that jobs work on."""
WORK_S = 400.0
"""For what a busy machine works on."""


class Page:
    """Keeps what it is given to show."""

    def __init__(self, *wishes: Wish | Chunk) -> None:
        self.told: list[str] = []
        self.tray: list[str] = []
        self.faults: list[str] = []
        self._wishes = list(wishes)

    def next_wish(self) -> Wish | Chunk | None:
        return self._wishes.pop(0) if self._wishes else None

    def show(self, section: Any) -> None:
        if isinstance(section, Tray):
            self.faults = [file.fault for file in section.files]
            self.tray = [file.name for file in section.files]

    def tell(self, message: Any) -> None:
        if isinstance(message, Told):
            self.told.append(message.text)


def test_a_result_that_cannot_be_kept_is_told_and_the_page_goes_on(tmp_path: Path) -> None:
    queue, page, kept = JobQueue([sys.executable, "-c", ""]), Page(), tmp_path / "kept"
    desk = StartDesk(Given(tmp_path / "runs"), queue)
    kept.mkdir()
    queue.add(Plan("calibrate", (), report=kept))

    def is_told() -> bool:
        desk.turn(page)  # type: ignore[arg-type]
        return bool(page.told)

    assert until(is_told)
    assert "see that you may write it" in page.told[0]
    desk.close()


def test_what_a_job_needs_is_not_deleted(tmp_path: Path) -> None:
    """A live job's settings name the calibration, its command does not."""
    queue, runs = JobQueue([sys.executable, "-c", ""]), tmp_path / "runs"
    desk, rig = StartDesk(Given(runs), queue), kept_calibration(runs, "room")
    rig.parent.mkdir()
    rig.write_text("{}")
    waits = queue.add(Plan("live", (), needs=(rig,), kind="page"))
    page = Page(Delete("calibration", "room"))
    desk.turn(page)  # type: ignore[arg-type]
    assert page.told == ["a job uses room: end it first"]
    queue.cancel(waits.number)
    until(lambda: queue.turn() or waits.is_over)
    page = Page(Delete("calibration", "room"))
    desk.turn(page)  # type: ignore[arg-type]
    assert page.told == ["room is deleted"]
    assert not rig.exists()
    desk.close()


def test_a_file_that_was_there_twice_is_good_once_the_other_is_taken_away(tmp_path: Path) -> None:
    desk, content = StartDesk(Given(tmp_path / "runs")), b"no video, but twice the same"
    wishes: list[Wish | Chunk] = []
    for number in (1, 2):
        wishes.append(Begin(number, f"{number}.avi", len(content)))
        wishes.append(Chunk(number, 0, memoryview(content)))
    page, later = Page(*wishes), Page(Drop(1))
    assert until(lambda: turned(desk, page) and "the same file" in "".join(page.faults))
    assert until(lambda: turned(desk, later) and "gives no picture" in "".join(later.faults))
    desk.close()


def turned(desk: StartDesk, page: Page) -> bool:
    desk.turn(page)  # type: ignore[arg-type]
    return True


def test_the_videos_of_a_job_that_failed_can_be_had_again(tmp_path: Path) -> None:
    """With the names that their user knows, not those of a clip's cameras."""
    queue = JobQueue([sys.executable, "-c"])
    desk, page = StartDesk(Given(tmp_path / "runs"), queue), Page(Again(1))
    copied = tmp_path / "runs/.clips/walk/cam1.avi"
    copied.parent.mkdir(parents=True)
    copied.write_bytes(b"video")
    job = queue.add(Plan("fails", ("exit(2)",), ((Path("up/front.avi"), copied),), run="walk"))
    assert until(lambda: turned(desk, Page()) and job.is_over)
    assert job.shown().again
    assert copied.is_file(), "they are kept as long as the job is shown"
    desk.turn(page)  # type: ignore[arg-type]
    assert [path.name for path in (tmp_path / "runs/.uploads").glob("*/*")] == ["front.avi"]
    assert not copied.parent.exists()
    assert not job.shown().again
    desk.close()


@pytest.mark.slow
def test_the_pages_own_commands_run(tmp_path: Path, clip: Path) -> None:
    """Report, comparison, demo and recording as processes, of a run of one second."""
    runs, queue = tmp_path / "runs", JobQueue()
    for name in ("one", "two"):
        write_video(tmp_path / f"{name}.avi", film_of(clip / "cam1.avi")[: FRAMES[name]])
        done(queue, Plan(name, ("single", str(tmp_path / f"{name}.avi"), "--out", str(runs))))
    desk = StartDesk(Given(runs), queue)
    desk.turn(Page(Report("one"), Compare("one", "two"), Demo()))  # type: ignore[arg-type]
    jobs = [job for job in queue.jobs if not job.is_over]
    assert [job.plan.arguments[0] for job in jobs] == ["report", "compare", "demo"]
    seen = set[str]()

    def are_over() -> bool:
        desk.turn(Page())  # type: ignore[arg-type]
        seen.update(job.shown().bus for job in jobs)
        if page_of(jobs[2]):
            with suppress(OSError), urlopen(page_of(jobs[2])):
                queue.cancel(jobs[2].number)
        return all(job.is_over for job in jobs)

    assert until(are_over, WORK_S), [job.progress.lines[-3:] for job in jobs]
    assert [job.state for job in jobs] == ["done"] * 3, [job.told for job in jobs]
    assert [job.shown().made for job in jobs] == [
        "run/one/report.html",
        "run/one/compare.html",
        "",
    ]
    assert any(bus.startswith("tcp/127.0.0.1:") for bus in seen)
    cameras = [word for name in FRAMES for word in ("--camera", str(tmp_path / f"{name}.avi"))]
    out = tmp_path / "recorded"
    done(queue, Plan("record", ("record", "--out", str(out), *cameras, "--seconds", "2")))
    assert {path.name for path in out.iterdir()} == {"cam1.avi", "cam2.avi", "meta.json"}
    desk.close()


@pytest.mark.slow
@pytest.mark.parametrize("task", ["poles", "markers"])
def test_the_page_of_points_to_click_is_opened(tmp_path: Path, clip: Path, task: Task) -> None:
    queue, files = JobQueue(), [Dropped(clip / f"cam{n}.avi") for n in (1, 2)]
    plan = planned(Work(task, name="room"), files, Known(tmp_path))
    place(plan)
    job = queue.add(plan)
    assert until(lambda: queue.turn() or page_of(job), WORK_S), job.progress.lines
    with urlopen(page_of(job)) as page:
        assert b"marking.js" in page.read()
    queue.cancel(job.number)
    assert until(lambda: queue.turn() or job.is_over, WORK_S)
    assert (job.state, job.told) == ("done", "closed"), job.progress.lines


def page_of(job: Job) -> str:
    """Address of a job's own page, while it has one."""
    return job.shown().address


def done(queue: JobQueue, plan: Plan) -> None:
    job = queue.add(plan)
    assert until(lambda: queue.turn() or job.is_over, WORK_S)
    assert job.state == "done", (job.told, job.progress.lines)


def test_no_command_takes_a_runs_name_for_an_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the present folder a run --force would be one."""
    monkeypatch.chdir(tmp_path)
    desk = StartDesk(Given(Path(".")))
    assert Path(desk.hello.runs) == tmp_path
    desk.close()


def all_over(desk: StartDesk, page: Page, queue: JobQueue) -> bool:
    return turned(desk, page) and all(job.is_over for job in queue.jobs)


RECORDS = """
import os, pathlib, sys
clip = pathlib.Path(sys.argv[3])
clip.mkdir(parents=True)
for camera in ("cam1", "cam2"):
    (clip / f"{camera}.avi").write_bytes(camera.encode())
if float(sys.argv[-1]) > 5:
    (clip / "meta.json").write_text('{"capture_s": {"cam1": [0.0, 0.5], "cam2": [0.25, 0.75]}}')
"""
"""Stands in for `tritrack record`: a recording of 5 seconds is never whole."""


def test_what_was_recorded_is_in_the_tray_and_in_the_list_until_it_is_deleted(
    tmp_path: Path, clip: Path
) -> None:
    """Files that are in the tray already are left alone; their times go where the videos go."""
    queue, cameras = JobQueue([sys.executable, "-c", RECORDS]), tuple(clip.glob("cam*.avi"))
    desk = StartDesk(Given(tmp_path / "runs", cameras), queue)
    recorded = tmp_path / "runs/.recorded"
    assert turned(desk, Page())
    both = ("file0", "file1")
    for seconds, name in ((4.0, "torn"), (9.0, "walk"), (9.0, "squat")):
        page = Page(Record(both, seconds, name))
        assert until(partial(all_over, desk, page, queue))
        desk._jobs_due_s = 0.0
        turned(desk, page)
        turned(desk, page)
        wanted = [] if name == "torn" else ["walk_cam1.avi", "walk_cam2.avi"]
        assert page.tray == wanted, name
    assert sorted(path.name for path in recorded.iterdir()) == ["squat", "walk"]
    full = Page(*(Begin(n, f"{n}.avi", 9) for n in range(5)), Take("squat"))
    turned(desk, full)
    assert (len(full.tray), len(full.told)) == (7, 1), "all of them or none"
    page = Page(Drop(None), Take("squat"), Delete("recording", "walk"), Take("walk"))
    turned(desk, page)
    assert page.tray == ["squat_cam1.avi", "squat_cam2.avi"]
    assert page.told == ["walk is deleted", "there is no recording 'walk' any more"]
    assert [path.name for path in recorded.iterdir()] == ["squat"]
    files = desk._uploads.files
    assert [file.times_s for file in files] == [(0.0, 0.5), (0.25, 0.75)]
    dropped = [Dropped(file.path, 2, file.times_s, file.recording) for file in reversed(files)]
    plan = planned(Work("track"), dropped, Known(tmp_path / "runs"))
    place(plan)
    (meta,) = (tmp_path / "runs/.clips/squat").glob("meta.json")
    times = json.loads(meta.read_text())["capture_s"]
    assert times == {"cam1": [0.25, 0.75], "cam2": [0.0, 0.5]}, "as they were dropped"
    desk.close()


def test_a_recording_whose_command_was_killed_is_in_the_list(tmp_path: Path) -> None:
    """Also one that was cut short with the page itself."""
    queue, clip = JobQueue([sys.executable, "-c", "exit(1)"]), tmp_path / "runs/.recorded/walk"
    desk = StartDesk(Given(tmp_path / "runs"), queue)

    def leave(clip: Path) -> None:
        clip.mkdir(parents=True)
        for camera in ("cam1", "cam2"):
            (clip / f"{camera}.avi").write_bytes(b"RIFF")
            (clip / f"{camera}.times.txt").write_text("7.00000\n7.50000\n")

    leave(clip)
    queue.add(Plan("record", (), records=clip))
    assert until(partial(all_over, desk, Page(), queue))
    desk._jobs_due_s = 0.0
    turned(desk, Page())
    assert (clip / "meta.json").is_file()
    desk.close()
    leave(clip.with_name("squat"))
    StartDesk(Given(tmp_path / "runs")).close()
    assert (clip.with_name("squat") / "meta.json").is_file()


def test_two_recordings_of_one_name_become_two(tmp_path: Path, clip: Path) -> None:
    queue, cameras = JobQueue([sys.executable, "-c", RECORDS]), tuple(clip.glob("cam*.avi"))
    desk, both = StartDesk(Given(tmp_path / "runs", cameras), queue), ("file0", "file1")
    assert turned(desk, Page())
    turned(desk, Page(Record(both, 9.0, "walk"), Record(both, 9.0, "walk")))
    folders = [job.plan.records for job in queue.jobs]
    assert [each.name for each in folders if each] == ["walk", "walk_2"]
    desk.close()


def test_what_the_board_showed_stays_where_calibrating_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a number that no board has, or as too many jobs wait: the user need not show it again."""
    queue = JobQueue([sys.executable, "-c", "input()"])
    desk, ended = StartDesk(Given(tmp_path / "runs"), queue), list[tuple[object, ...]]()

    def watch(*given: object) -> tuple[Path, ...]:
        ended.append(given)
        return ()

    monkeypatch.setattr(desk._lists, "watch", watch)
    page = Page(Watched(square_mm=4000.0))
    turned(desk, page)
    for _ in range(5):
        queue.add(Plan("waits", ()))
        queue.turn()
    full = Page(Watched(square_mm=40.0))
    turned(desk, full)
    assert "the side of a square, in mm, must be from 1 to 1000" in page.told[0]
    assert full.told == ["4 jobs wait already: let one end, or cancel one"]
    assert ended == []
    desk.close()


def test_a_folder_that_fails_is_told_and_the_page_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk, page = StartDesk(Given(tmp_path / "runs")), Page()

    def fail(_: Path) -> None:
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(start_lists, "found_runs", fail)
    turned(desk, page)
    assert "Input/output error" in page.told[0]
    monkeypatch.undo()
    desk.close()


def test_cameras_are_not_open_beside_a_recording_that_waited_for_its_turn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A device can be opened by one program alone."""
    monkeypatch.setattr(start_lists, "cameras_of", lambda _: [FoundCamera("v9", "a", "b", 99)])
    queue, look = JobQueue([sys.executable, "-c", "input()"]), Look(on=True)
    desk, page = StartDesk(Given(tmp_path / "runs"), queue), Page(look)
    before = queue.add(Plan("waits", ("track",)))
    waits = queue.add(Plan("record", ("record", "--out")))
    turned(desk, page)
    assert (desk._lists.shows, page.told) == (True, [])
    queue.cancel(before.number)

    def is_begun() -> bool:
        return turned(desk, Page()) and waits.state == "running" and not desk._lists.shows

    assert until(is_begun)
    again = Page(look)
    turned(desk, again)
    assert again.told == ["a live run or a recording has the cameras: end it first"]
    assert not desk._lists.shows
    desk.close()
