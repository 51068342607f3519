"""What the start page shows and what its users' wishes do."""

import shutil
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from animator.page.page_server import File
from animator.page.wish_page import Told
from animator.start.sections import Got, Hello
from animator.start.start_page import StartPage
from animator.start.wishes import (
    Again,
    AnyWish,
    Begin,
    Cancel,
    Chunk,
    Delete,
    Drop,
    Live,
    Look,
    Raise,
    Record,
    Take,
    Watch,
    Watched,
    WishError,
    Work,
)
from common.atomic_file import unwritten
from common.bus.messages import MOST_VIEWS
from common.video.decoding import Decoder
from runtime.store.run_exports import OWN_NAMES
from tritrack.recording_cameras.recorded_clips import (
    RECORDED,
    finish_recording,
    recorded_videos,
    recording_names,
    remove_recording,
)
from tritrack.starting.aside import Aside
from tritrack.starting.calibration_list import remove_calibration
from tritrack.starting.job_plan import PlanError, kept_calibration, refuse_numbers
from tritrack.starting.job_queue import Job, JobQueue
from tritrack.starting.start_files import clean, delete_run, place, remove, served
from tritrack.starting.start_lists import StartLists
from tritrack.starting.tray import Facts, facts_of, late_by_sound, shown_tray
from tritrack.starting.uploads import FOLDER, MOST_BYTES, Upload, UploadRefused, Uploads
from tritrack.starting.wish_plans import Starting, There, plan_of, refuse_cameras

JOBS_S: Final = 0.3
"""Interval at which jobs are shown, seconds."""
MOST_WISHES: Final = 64
"""Largest number of wishes that are heard in a row."""


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
        self._runs = given.runs.absolute()  # no command may take a folder's name for an option
        self._queue = JobQueue() if queue is None else queue
        self._uploads = Uploads(self._runs / FOLDER)
        self._facts: dict[int, Facts] = {}
        self._late_s: dict[tuple[int, int], float | None] = {}
        """By the numbers of the first and another video, where asked for."""
        self._aside = Aside()
        self._lists = StartLists(self._runs, given.videos, self._aside)
        self._jobs_due_s = 0.0
        self._board = self._runs / FOLDER / "board"
        """What the board shows to the cameras."""
        clean(self._runs, self._queue.uses)
        for clip in (self._runs / RECORDED).glob("*/"):
            finish_recording(clip)  # this machine went off while it recorded

    @property
    def hello(self) -> Hello:
        """The first message to browsers."""
        return Hello(
            runs=str(self._runs),
            formats=tuple(OWN_NAMES),
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
            except OSError as error:
                page.tell(self._unwritten(error))
        self._aside.turn()
        self._hear_sounds()
        page.show(shown_tray(self._uploads.files, self._facts, self._late_s))
        try:
            if time.monotonic() >= self._jobs_due_s:
                self._jobs_due_s = time.monotonic() + JOBS_S
                self._show_jobs(page)
            self._lists.turn(page)
        except OSError as error:
            page.tell(self._unwritten(error))

    def close(self) -> None:
        """End the jobs, close the cameras, remove what was only dropped."""
        self._queue.close()
        self._lists.close()
        self._aside.close()
        self._uploads.close()
        clean(self._runs, lambda _: False)

    def _unwritten(self, error: OSError) -> Told:
        return Told(unwritten(self._runs, error, "see that you may write it"), well=False)

    def _do(self, wish: AnyWish | Chunk, page: StartPage) -> None:
        """Carry out one wish.

        Raises:
            UploadRefused, PlanError: When it cannot be.
        """
        if isinstance(wish, Chunk | Begin | Drop | Raise):
            self._receive(wish, page)
        elif isinstance(wish, Again):
            for path, name in self._queue.videos_of(wish.job):
                self._look_at(self._uploads.put_back(path, name))
                remove(path)
            clean(self._runs, self._queue.keeps)
        elif isinstance(wish, Take):
            self._take(wish.name)
        elif isinstance(wish, Cancel):
            self._queue.cancel(wish.job)
        elif isinstance(wish, Look):
            if wish.on and self._queue.holds_cameras and self._lists.has_devices:
                raise PlanError("a live run or a recording has the cameras: end it first")
            self._lists.look(wish.on)
        elif isinstance(wish, Watch):
            refuse_cameras(wish.cameras, self._lists.sources, least=0)
            self._lists.watch((), self._board)
            shutil.rmtree(self._board, ignore_errors=True)
            self._lists.watch(wish.cameras, self._board)
        elif isinstance(wish, Delete):
            self._delete(wish, page)
        else:
            job = self._begun(wish)
            page.tell(Told(f"{job.plan.title}: see Work", well=True))
        self._jobs_due_s = 0.0

    def _receive(self, wish: Chunk | Begin | Drop | Raise, page: StartPage) -> None:
        if isinstance(wish, Drop):
            self._uploads.drop(wish.file)
            there = {one.number for one in self._uploads.files}
            self._facts = {n: facts for n, facts in self._facts.items() if n in there}
            self._late_s = {pair: s for pair, s in self._late_s.items() if {*pair} <= there}
            for one in self._uploads.files:
                if one.number in self._facts and self._facts[one.number].twin not in {None, *there}:
                    self._look_at(one)
            return
        if isinstance(wish, Raise):
            self._uploads.earlier(wish.file)
            return
        found = self._uploads.begin(wish) if isinstance(wish, Begin) else self._uploads.take(wish)
        if found is None:
            return
        page.tell(Got(found.number, found.got))
        if found.is_whole and found.number not in self._facts:
            self._look_at(found)

    def _look_at(self, upload: Upload) -> None:
        """Have the facts of a whole file found."""
        others = [one for one in self._uploads.files if one.is_whole and one is not upload]
        self._aside.ask(
            lambda decoder: facts_of(upload, decoder, others), self._keep(upload.number)
        )

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
        there = There(
            self._runs, self._uploads.files, self._facts, self._lists.sources, self._queue.names
        )
        self._queue.refuse_one_more()
        if isinstance(wish, Watched):
            # While what was watched is still there.
            refuse_numbers(Work("board", square_mm=wish.square_mm))
            there = there._replace(board=self._lists.watch((), self._board))
        plan = plan_of(wish, there)
        if isinstance(wish, Live | Watched | Record):
            self._lists.look(False)  # only one program can hold a camera
        place(plan)
        job = self._queue.add(plan)
        if isinstance(wish, Work) and plan.run:
            self._uploads.drop(None)
            self._facts, self._late_s = {}, {}
        return job

    def _delete(self, wish: Delete, page: StartPage) -> None:
        path, delete = {
            "run": (self._runs / wish.name, delete_run),
            "calibration": (kept_calibration(self._runs, wish.name), remove_calibration),
            "recording": (self._runs / RECORDED / wish.name, remove_recording),
        }[wish.what]
        if self._queue.uses(path):
            raise PlanError(f"a job uses {wish.name}: end it first")
        gone = delete(self._runs, wish.name)
        clean(self._runs, self._queue.keeps)
        text = f"{wish.name} is deleted" if gone else f"there is no {wish.what} {wish.name!r}"
        page.tell(Told(text, gone))
        self._lists.hurry()

    def _take(self, name: str) -> None:
        """Put the videos of a recording into the tray, in the order of its cameras.

        Raises:
            PlanError: When there is none of that name.
            UploadRefused: When one finds no room.
        """
        videos = recorded_videos(self._runs, name)
        if not videos:
            raise PlanError(f"there is no recording {name!r} any more")
        self._uploads.refuse_more(len(videos))
        for video in videos:
            self._look_at(self._uploads.put_back(video, f"{name}_{video.name}"))

    def _recorded(self, clip: Path) -> None:
        """Show a clip that was recorded, also by a command that was killed; one that did not come
        about leaves nothing."""
        finish_recording(clip)
        if clip.name not in recording_names(self._runs):
            remove(clip)
        elif not self._uploads.files:
            self._take(clip.name)

    def _show_jobs(self, page: StartPage) -> None:
        ended = self._queue.turn()
        if self._queue.holds_cameras and self._lists.has_devices and self._lists.shows:
            self._lists.look(False)  # one that waited begins, and its cameras may be open
        for job in ended:
            if job.plan.report is not None and job.state == "done":
                job.plan.report.write_text("\n".join(job.progress.lines) + "\n")
            if job.plan.records is not None:
                self._recorded(job.plan.records)
        if ended:
            clean(self._runs, self._queue.keeps)
            self._lists.hurry()
        page.show(self._queue.shown())


def _late(first: Path, other: Path, _decoder: Decoder) -> float | None:
    return late_by_sound(first, other)
