"""What is behind the start page, without a server: it goes on whatever fails around it."""

import sys
from pathlib import Path
from typing import Any

import pytest
from waiting import until

from animator.start.wishes import Again, Delete, Wish
from tritrack.starting.job_plan import Plan, kept_calibration
from tritrack.starting.job_queue import JobQueue
from tritrack.starting.start_desk import Given, StartDesk


class Page:
    """Keeps what it is given to show."""

    def __init__(self, *wishes: Wish) -> None:
        self.told: list[str] = []
        self._wishes = list(wishes)

    def next_wish(self) -> Wish | None:
        return self._wishes.pop(0) if self._wishes else None

    def show(self, section: Any) -> None:
        """Not looked at here."""

    def tell(self, message: Any) -> None:
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


def test_no_command_takes_a_runs_name_for_an_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the present folder a run --force would be one."""
    monkeypatch.chdir(tmp_path)
    desk = StartDesk(Given(Path(".")))
    assert Path(desk.hello.runs) == tmp_path
    desk.close()
