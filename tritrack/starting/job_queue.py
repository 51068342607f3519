"""The commands that the page runs: one at a time, a few that wait, and one page of a run."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Final
from urllib.parse import quote

from animator.start.sections import Jobs, ShownJob, State
from runtime.terminal import PROGRESS
from tritrack.recording_cameras.recorded_clips import RECORDED
from tritrack.starting.job_plan import Kind, Plan, PlanError
from tritrack.starting.job_progress import Progress, step, words
from tritrack.stopping import STARTER, STARTER_PIPE

MOST_WAITING: Final = 4
MOST_KEPT: Final = 12
"""Largest number of jobs that are over and still shown."""
ENDS_S: Final = 15.0
"""Seconds until a command that was asked to end is killed."""
LAST_WORDS_S: Final = 1.0
"""Seconds to wait for the last lines of a command that is over."""
COLUMNS: Final = "100"
"""Width of the tables that commands print."""
RESULTS: Final = {0: "", 3: "written, but hardly to be believed"}
"""Exit codes of a command whose results are there."""


@dataclass
class Job:
    """A command, waiting, running or over."""

    number: int
    plan: Plan
    state: State = "waiting"
    progress: Progress = field(default_factory=Progress)
    process: "subprocess.Popen[str] | None" = None
    hearing: threading.Thread | None = None
    """Reads what it prints."""
    began_s: float = 0.0
    asked_s: float = 0.0
    """When it was asked to end; 0: never."""
    told: str = ""

    @property
    def made(self) -> str:
        """Address of the file that it made; "": none."""
        file = self.plan.makes
        if self.state != "done" or file is None or not file.is_file():
            return ""
        return f"run/{quote(os.fsencode(file.parent.name))}/{quote(file.name)}"

    @property
    def is_over(self) -> bool:
        """Whether it is neither waiting nor running."""
        return self.state not in ("waiting", "running")

    @property
    def gives_back(self) -> bool:
        """Whether its videos may come to the tray again: it left no run."""
        return self.state in ("failed", "cancelled") and any(
            to.exists() for _, to in self.plan.videos
        )

    def shown(self) -> ShownJob:
        """In the form for browsers."""
        running = self.state == "running"
        seconds = time.monotonic() - self.began_s
        return ShownJob(
            job=self.number,
            title=self.plan.title,
            command=self.plan.command,
            state=self.state,
            share=round(self.progress.share, 3),
            doing=words(self.progress, self.plan.frames, seconds) if running else "",
            lines=self.progress.lines,
            told=self.told,
            run=self.plan.run,
            address=self.progress.address if running and self.plan.kind == "page" else "",
            bus=self.progress.bus if running else "",
            again=self.gives_back,
            made=self.made,
        )


class JobQueue:
    """Runs plans as child processes.

    Args:
        program: What runs the command `tritrack`, in words.
    """

    def __init__(self, program: Sequence[str] = (sys.executable, "-m", "tritrack")) -> None:
        self._program = tuple(program)
        self._jobs: list[Job] = []
        self._count = 0

    def add(self, plan: Plan) -> Job:
        """Let a plan wait for its turn; another page ends the present one.

        Raises:
            PlanError: When too many wait.
        """
        self.refuse_one_more()
        if plan.kind == "page":
            for job in self._jobs:
                if job.plan.kind == "page" and not job.is_over:
                    self.cancel(job.number)
        self._count += 1
        self._jobs.append(Job(self._count, plan))
        over = [job for job in self._jobs if job.is_over]
        for job in over[: max(0, len(over) - MOST_KEPT)]:
            self._jobs.remove(job)
        return self._jobs[-1]

    def refuse_one_more(self) -> None:
        """Refuse a further plan where too many wait.

        Raises:
            PlanError: When they do.
        """
        if sum(job.state == "waiting" for job in self._jobs) >= MOST_WAITING:
            raise PlanError(f"{MOST_WAITING} jobs wait already: let one end, or cancel one")

    def cancel(self, number: int) -> None:
        """End a job, or take it out of the queue."""
        for job in self._jobs:
            if job.number != number or job.is_over or job.asked_s:
                continue
            if job.process is None:
                job.state = "cancelled"
            else:
                job.asked_s = time.monotonic()
                job.process.terminate()

    @property
    def jobs(self) -> tuple[Job, ...]:
        """All of them, the newest last."""
        return tuple(self._jobs)

    @property
    def names(self) -> frozenset[str]:
        """Of the runs and recordings that jobs write or will write."""
        going = [job.plan for job in self._jobs if not job.is_over]
        runs = {plan.run for plan in going if plan.run}
        return frozenset(runs | {plan.records.name for plan in going if plan.records is not None})

    @property
    def holds_cameras(self) -> bool:
        """Whether a live run or a recording goes on, which alone may hold its cameras."""
        going = [job.plan for job in self._jobs if job.state == "running"]
        return any(plan.arguments[:1] in (("live",), ("record",)) for plan in going)

    def uses(self, path: Path) -> bool:
        """Whether a job that is not over needs a path or something in it, or writes a run there."""
        going = [job.plan for job in self._jobs if not job.is_over]
        words = [Path(word) for plan in going for word in plan.arguments]
        words += [path for plan in going for path in plan.needs]
        is_recording = path.parent.name == RECORDED  # its name is no run's
        written = any(plan.run and plan.run == path.name for plan in going) and not is_recording
        return written or any(word == path or path in word.parents for word in words)

    def videos_of(self, number: int) -> tuple[tuple[Path, str], ...]:
        """The videos that a job that failed or was cancelled had copied, with their names."""
        jobs = [job for job in self._jobs if job.number == number and job.gives_back]
        return tuple((to, source.name) for job in jobs for source, to in job.plan.videos)

    def keeps(self, path: Path) -> bool:
        """Whether a job uses a path, or its videos are in there and can be had again."""
        given_back = [to for job in self._jobs if job.gives_back for _, to in job.plan.videos]
        return self.uses(path) or any(path in to.parents for to in given_back)

    def shown(self) -> Jobs:
        """All of them."""
        return Jobs([job.shown() for job in self._jobs])

    def turn(self) -> list[Job]:
        """Begin what can begin and close what is over; returns what has just ended."""
        ended = []
        for job in self._jobs:
            if job.process is not None and job.state == "running":
                ended += [job] if self._has_ended(job) else []
        kinds: tuple[Kind, ...] = ("work", "page")
        for kind in kinds:
            alike = [job for job in self._jobs if job.plan.kind == kind and not job.is_over]
            if alike and alike[0].state == "waiting":
                self._begin(alike[0])
        return ended

    def close(self) -> None:
        """End all."""
        for job in self._jobs:
            self.cancel(job.number)
        until_s = time.monotonic() + ENDS_S
        for job in self._jobs:
            if job.process is not None and not job.is_over:
                try:
                    job.process.wait(max(0.1, until_s - time.monotonic()))
                except subprocess.TimeoutExpired:
                    job.process.kill()
                    job.process.wait()

    def _begin(self, job: Job) -> None:
        environment = {**os.environ, PROGRESS: "lines", "COLUMNS": COLUMNS, "PYTHONUNBUFFERED": "1"}
        environment[STARTER] = STARTER_PIPE
        job.process = subprocess.Popen(
            [*self._program, *job.plan.arguments],
            stdin=subprocess.PIPE,  # open as long as we live, which ends it otherwise
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=environment,
        )
        job.state, job.began_s = "running", time.monotonic()
        assert job.process.stdout is not None
        job.hearing = threading.Thread(target=_hear, args=(job, job.process.stdout), daemon=True)
        job.hearing.start()

    def _has_ended(self, job: Job) -> bool:
        assert job.process is not None
        code = job.process.poll()
        if code is None:
            if job.asked_s and time.monotonic() - job.asked_s > ENDS_S:
                job.process.kill()
            return False
        if job.hearing is not None:
            job.hearing.join(LAST_WORDS_S)
        job.state, job.told = ending_of(code, job)
        return True


def ending_of(code: int, job: Job) -> tuple[State, str]:
    """How a job ended, by its exit code and its lines."""
    if job.plan.kind == "page" and (job.asked_s or code == 0):
        return "done", "closed"
    if job.asked_s:
        return "cancelled", "stopped before it was done"
    fault = job.progress.fault
    if code in RESULTS:
        return "done", fault or RESULTS[code]
    return "failed", fault or f"it ended with code {code}: see what it printed"


def _hear(job: Job, lines: IO[str]) -> None:
    """A thread: reads what a command prints, so that it never waits for us."""
    with lines:
        for line in lines:
            job.progress = step(job.progress, line)
