"""The page's commands as processes: one at a time, a few that wait, each of which can be ended."""

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from test_own_process import ended_within, written
from waiting import until

from tritrack.starting.job_plan import Plan, PlanError
from tritrack.starting.job_queue import MOST_KEPT, MOST_WAITING, Job, JobQueue

SLEEPS = Plan("sleeps", ("import time; print('here', flush=True); time.sleep(60)",))


@pytest.fixture
def queue() -> Iterator[JobQueue]:
    """Its program is Python, its plans' arguments what Python runs."""
    one = JobQueue((sys.executable, "-c"))
    yield one
    one.close()


def ended(queue: JobQueue, job: Job) -> Job:
    assert until(lambda: queue.turn() or job.is_over)
    return job


def test_one_work_runs_at_a_time_and_the_next_follows(queue: JobQueue) -> None:
    first, second = queue.add(SLEEPS), queue.add(Plan("prints", ("print('walked')",)))
    queue.turn()
    assert (first.state, second.state) == ("running", "waiting")
    queue.cancel(first.number)
    assert ended(queue, first).state == "cancelled"
    assert ended(queue, second).state == "done"
    assert second.shown().lines == ("walked",)


def test_a_page_opens_beside_the_work_and_another_takes_its_place(queue: JobQueue) -> None:
    address = "http://127.0.0.1:1"
    code = f"import time; print('the page is at {address}', flush=True); time.sleep(60)"
    page = Plan("page", (code,), kind="page")
    work, first = queue.add(SLEEPS), queue.add(page)
    queue.turn()
    assert (work.state, first.state) == ("running", "running")
    assert until(lambda: first.shown().address == address)
    second = queue.add(page)
    assert ended(queue, first).state == "done"
    assert until(lambda: queue.turn() or second.state == "running")
    assert first.shown().address == ""


def test_what_fails_says_why_and_with_which_cure(queue: JobQueue) -> None:
    code = "import sys; print('error: a.mp4 is empty: record it again', flush=True); sys.exit(2)"
    job = ended(queue, queue.add(Plan("fails", (code,))))
    assert (job.state, job.told) == ("failed", "a.mp4 is empty: record it again")


def test_progress_is_asked_for_and_shown(queue: JobQueue) -> None:
    code = (
        "import os, time; assert os.environ['TRITRACK_PROGRESS'] == 'lines'; "
        """print('progress {"what": "posing", "done": 1.5, "of": 3}', flush=True); time.sleep(60)"""
    )
    job = queue.add(Plan("works", (code,), frames=10))
    queue.turn()
    assert until(lambda: job.shown().share == 0.5)
    assert job.shown().doing.startswith("posing (2 of 3): 5 of 10 frames")


def test_no_more_wait_than_a_few_and_no_more_are_kept(queue: JobQueue) -> None:
    running = queue.add(SLEEPS)
    queue.turn()
    waiting = [queue.add(SLEEPS) for _ in range(MOST_WAITING)]
    with pytest.raises(PlanError, match="let one end, or cancel one"):
        queue.add(SLEEPS)
    for job in waiting:
        queue.cancel(job.number)
        assert job.state == "cancelled", "one that waits ends at once"
    for _ in range(2 * MOST_KEPT):
        queue.cancel(queue.add(SLEEPS).number)
    assert len(queue.shown().jobs) <= MOST_KEPT + 2
    assert running.state == "running"


def test_what_a_job_reads_and_writes_is_in_use_until_it_is_over(queue: JobQueue) -> None:
    job = queue.add(
        Plan("walk", ("pass", "runs/.clips/walk/cam1.avi", "--out", "runs"), run="walk")
    )
    assert queue.uses(Path("runs/.clips/walk"))
    assert not queue.uses(Path("runs/.clips/wal"))
    assert queue.uses(Path("runs/walk"))
    assert queue.names == {"walk"}
    assert ended(queue, job).state == "done"
    assert not queue.uses(Path("runs/.clips/walk"))
    assert queue.names == frozenset()


def test_what_a_jobs_settings_name_is_in_use_too(queue: JobQueue) -> None:
    rig = Path("runs/.calibrations/room.json")
    job = queue.add(Plan("live", ("pass",), needs=(rig,)))
    assert queue.uses(rig)
    assert ended(queue, job).state == "done"
    assert not queue.uses(rig)


PAGE = """
import sys, time
from pathlib import Path
from tritrack.starting.job_plan import Plan
from tritrack.starting.job_queue import JobQueue
queue = JobQueue((sys.executable, "-c"))
queue.add(Plan("sleeps", (sys.argv[1],)))
queue.turn()
time.sleep(60)
"""
WORK = """
import os, time, tritrack.stopping as it
from pathlib import Path
it.heed_in_order(); it.end_with_starter()
Path({number!r}).write_text(str(os.getpid()))
try:
    time.sleep(60)
finally:
    Path({ended!r}).write_text("in order")
"""


def test_a_job_ends_in_order_when_its_page_is_killed(tmp_path: Path) -> None:
    number, end = tmp_path / "number", tmp_path / "ended"
    work = WORK.format(number=str(number), ended=str(end))
    page = subprocess.Popen([sys.executable, "-c", PAGE, work])
    job = written(number)
    page.kill()
    page.wait()
    assert ended_within(job, 20.0)
    assert end.read_text() == "in order"


def test_what_a_job_made_can_be_opened_once_it_is_there(queue: JobQueue, tmp_path: Path) -> None:
    made = tmp_path / "a run ü/report.html"
    job = ended(queue, queue.add(Plan("reports", ("pass",), makes=made)))
    assert job.shown().made == ""
    made.parent.mkdir()
    made.write_text("all")
    assert job.shown().made == "run/a%20run%20%C3%BC/report.html"
    failed = ended(queue, queue.add(Plan("fails", ("exit(2)",), makes=made)))
    assert failed.shown().made == "", "that is of before"


def test_closing_ends_what_runs(queue: JobQueue) -> None:
    job = queue.add(SLEEPS)
    queue.turn()
    assert until(lambda: job.progress.lines)
    before_s = time.monotonic()
    queue.close()
    assert job.process is not None
    assert job.process.poll() is not None
    assert time.monotonic() - before_s < 10.0


def test_a_recording_is_not_used_by_a_run_of_its_name(tmp_path: Path) -> None:
    """The run has the videos as its own; the recording may be deleted meanwhile."""
    queue, recording = JobQueue(), tmp_path / ".recorded" / "walk"
    queue.add(Plan("walk", ("track", str(tmp_path / ".clips" / "walk")), run="walk"))
    assert queue.uses(tmp_path / "walk")
    assert queue.uses(tmp_path / ".clips" / "walk")
    assert not queue.uses(recording)
    queue.add(Plan("record", ("record", "--out", str(recording)), records=recording))
    assert queue.uses(recording)
