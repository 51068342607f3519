"""The page's commands as processes: one at a time, a few that wait, each of which can be ended."""

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
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


def test_closing_ends_what_runs(queue: JobQueue) -> None:
    job = queue.add(SLEEPS)
    queue.turn()
    assert until(lambda: job.progress.lines)
    before_s = time.monotonic()
    queue.close()
    assert job.process is not None
    assert job.process.poll() is not None
    assert time.monotonic() - before_s < 10.0
