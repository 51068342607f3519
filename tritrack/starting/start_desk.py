"""What the start page shows and what its users' wishes do."""

import time
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NamedTuple, get_args

from animator.page.page_server import File
from animator.start.sections import Got, Hello, Told
from animator.start.start_page import StartPage
from animator.start.wishes import (
    AnyWish,
    Begin,
    Board,
    Cancel,
    Chunk,
    Compare,
    Delete,
    Drop,
    Export,
    Format,
    Live,
    Look,
    Open,
    Raise,
    Report,
    WishError,
    Work,
)
from common.bus.messages import MOST_VIEWS
from common.video.decoding import Decoder
from runtime.live.free_ports import free_port
from tritrack.machine_cameras.live_settings import live_settings
from tritrack.starting.aside import Aside
from tritrack.starting.calibration_list import calibration_names, remove_calibration
from tritrack.starting.job_plan import (
    CALIBRATIONS,
    CLIPS,
    Dropped,
    Known,
    Plan,
    PlanError,
    board_plan,
    free_name,
    kept_calibration,
    live_plan,
    planned,
    run_plan,
)
from tritrack.starting.job_queue import Job, JobQueue
from tritrack.starting.run_list import run_folder
from tritrack.starting.start_files import SETTINGS, clean, delete_run, place, served
from tritrack.starting.start_lists import StartLists
from tritrack.starting.tray import Facts, facts_of, late_by_sound, shown_tray
from tritrack.starting.uploads import FOLDER, MOST_BYTES, UploadRefused, Uploads

JOBS_S: Final = 0.3
"""Interval at which jobs are shown, seconds."""
MOST_WISHES: Final = 64
"""Largest number of wishes that are heard in a row."""
Starting = Work | Board | Open | Export | Report | Compare | Live
"""A wish that a command follows from."""


class Given(NamedTuple):
    """What the command was given."""

    runs: Path
    videos: tuple[Path, ...] = ()
    """They play as cameras."""


class StartDesk:
    """Everything behind the page but its server.

    Args:
        given: The command's options.
        queue: Runs the jobs.

    Raises:
        UploadRefused: When the folder of the runs cannot be written.
    """

    def __init__(self, given: Given, queue: JobQueue | None = None) -> None:
        self._runs = given.runs
        self._queue = JobQueue() if queue is None else queue
        self._uploads = Uploads(given.runs / FOLDER)
        self._facts: dict[int, Facts] = {}
        self._late_s: dict[tuple[int, int], float | None] = {}
        """By the numbers of the first and another video, where asked for."""
        self._aside = Aside()
        self._lists = StartLists(given.runs, given.videos, self._aside)
        self._jobs_due_s = 0.0
        clean(self._runs, self._queue.uses)

    @property
    def hello(self) -> Hello:
        """The first message to browsers."""
        return Hello(
            runs=str(self._runs),
            formats=get_args(Format),
            most_files=MOST_VIEWS,
            most_bytes=MOST_BYTES,
        )

    def file(self, path: str) -> File | None:
        """A picture or download; from the server's thread."""
        return served(path, self._runs, self._lists.pictures, self._lists.camera_jpeg)

    def turn(self, page: StartPage) -> None:
        """Hear what was asked, and show what has changed."""
        for _ in range(MOST_WISHES):
            try:
                wish = page.next_wish()
                if wish is None:
                    break
                self._do(wish, page)
            except (WishError, UploadRefused, PlanError) as error:
                page.tell(Told(str(error), well=False))
        self._aside.turn()
        self._hear_sounds()
        page.show(shown_tray(self._uploads.files, self._facts, self._late_s))
        if time.monotonic() >= self._jobs_due_s:
            self._jobs_due_s = time.monotonic() + JOBS_S
            self._show_jobs(page)
        self._lists.turn(page)

    def close(self) -> None:
        """End the jobs, close the cameras, remove what was only dropped."""
        self._queue.close()
        self._lists.close()
        self._aside.close()
        self._uploads.close()
        clean(self._runs, lambda _: False)

    def _do(self, wish: AnyWish | Chunk, page: StartPage) -> None:
        """Carry out one wish.

        Raises:
            UploadRefused, PlanError: When it cannot be.
        """
        if isinstance(wish, Chunk | Begin | Drop | Raise):
            self._receive(wish, page)
        elif isinstance(wish, Cancel):
            self._queue.cancel(wish.job)
        elif isinstance(wish, Look):
            self._lists.look(wish.on)
        elif isinstance(wish, Delete):
            self._delete(wish, page)
        else:
            job = self._begun(wish)
            page.tell(Told(f"{job.plan.title}: {job.plan.command}", well=True))
        self._jobs_due_s = 0.0

    def _receive(self, wish: Chunk | Begin | Drop | Raise, page: StartPage) -> None:
        if isinstance(wish, Drop):
            self._uploads.drop(wish.file)
            there = {one.number for one in self._uploads.files}
            self._facts = {n: facts for n, facts in self._facts.items() if n in there}
            self._late_s = {pair: s for pair, s in self._late_s.items() if {*pair} <= there}
            return
        if isinstance(wish, Raise):
            self._uploads.earlier(wish.file)
            return
        found = self._uploads.begin(wish) if isinstance(wish, Begin) else self._uploads.take(wish)
        if found is None:
            return
        page.tell(Got(found.number, found.got))
        if found.is_whole and found.number not in self._facts:
            upload = found
            self._aside.ask(lambda decoder: facts_of(upload, decoder), self._keep(upload.number))

    def _keep(self, number: int) -> Callable[[Facts], None]:
        def keep(facts: Facts) -> None:
            self._facts[number] = facts

        return keep

    def _hear_sounds(self) -> None:
        """Have each video's sound held against that of the first."""
        videos = [one for one in self._uploads.files if one.number in self._facts]
        for other in videos[1:]:
            pair = (videos[0].number, other.number)
            if pair not in self._late_s:
                self._late_s[pair] = None
                question = partial(_late, videos[0].path, other.path)
                self._aside.ask(question, partial(self._late_s.__setitem__, pair))

    def _begun(self, wish: Starting) -> Job:
        plan = self._plan(wish)
        place(plan)
        job = self._queue.add(plan)
        if isinstance(wish, Work) and plan.run:
            self._uploads.drop(None)
            self._facts, self._late_s = {}, {}
        return job

    def _plan(self, wish: Starting) -> Plan:
        if isinstance(wish, Work):
            return self._plan_of_files(wish)
        if isinstance(wish, Live):
            return self._plan_of_cameras(wish)
        if isinstance(wish, Board):
            (self._runs / CALIBRATIONS).mkdir(exist_ok=True)
            return board_plan(self._runs, wish.paper)
        named = [wish.run, wish.other] if isinstance(wish, Compare) else [wish.run]
        for name in named:
            if run_folder(self._runs, name) is None:
                raise PlanError(f"there is no run {name!r} any more")
        return run_plan(wish, self._runs, free_port())

    def _plan_of_files(self, wish: Work) -> Plan:
        tray = shown_tray(self._uploads.files, self._facts)
        if wish.task not in tray.tasks:
            raise PlanError("these files are not for that: drop one video, or two to eight")
        infos = {number: facts.info for number, facts in self._facts.items()}
        files = [
            Dropped(one.path, info.frames if (info := infos.get(one.number)) else 0)
            for one in self._uploads.files
        ]
        return planned(wish, files, self._known())

    def _known(self) -> Known:
        kept = calibration_names(self._runs)
        folders = [self._runs, self._runs / CLIPS]
        there = {path.name for folder in folders if folder.is_dir() for path in folder.iterdir()}
        names = there | {*kept} | self._queue.names
        return Known(self._runs, frozenset(names), frozenset(kept), find_spec("mcap") is not None)

    def _plan_of_cameras(self, wish: Live) -> Plan:
        known, there = self._known(), self._lists.sources
        if not wish.cameras or len(set(wish.cameras)) < len(wish.cameras):
            raise PlanError("choose one camera or more")
        if not {*wish.cameras} <= {*there} or len(wish.cameras) > MOST_VIEWS:
            raise PlanError("these cameras are not there any more: look again")
        if wish.calibration and wish.calibration not in known.calibrations:
            raise PlanError(f"there is no calibration {wish.calibration!r}: choose one of the list")
        name = free_name(time.strftime("live_%Y-%m-%d_%H%M"), known.names)
        rig = kept_calibration(self._runs, wish.calibration) if wish.calibration else None
        port = free_port()
        file = self._runs / SETTINGS / f"{name}.toml"
        file.parent.mkdir(exist_ok=True)
        sources = [there[each] for each in wish.cameras]
        file.write_text(live_settings(sources, port, rig, wish.pictures), "utf-8")
        self._lists.look(False)  # only one program can hold a camera
        return live_plan(file, self._runs, name, port)

    def _delete(self, wish: Delete, page: StartPage) -> None:
        if self._queue.uses(self._runs / wish.name):
            raise PlanError(f"a job uses {wish.name}: end it first")
        remove = delete_run if wish.what == "run" else remove_calibration
        gone = remove(self._runs, wish.name)
        text = f"{wish.name} is deleted" if gone else f"there is no {wish.what} {wish.name!r}"
        page.tell(Told(text, gone))
        self._lists.hurry()

    def _show_jobs(self, page: StartPage) -> None:
        ended = self._queue.turn()
        for job in ended:
            if job.plan.report is not None and job.state == "done":
                job.plan.report.write_text("\n".join(job.progress.lines) + "\n")
        if ended:
            clean(self._runs, self._queue.uses)
            self._lists.hurry()
        page.show(self._queue.shown())


def _late(first: Path, other: Path, _decoder: Decoder) -> float | None:
    return late_by_sound(first, other)
