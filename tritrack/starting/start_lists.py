"""The lists of the start page: runs with their pictures, calibrations, cameras."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from animator.start.start_page import StartPage
from common.video.decoding import Decoder
from common.video.pictures import Source, is_recorded
from runtime.store.past_run import PastRunError
from tritrack.machine_cameras.camera_list import FoundCamera, cameras_of
from tritrack.machine_cameras.camera_previews import Previews
from tritrack.recording_cameras.recorded_clips import shown_recordings
from tritrack.starting.aside import Aside
from tritrack.starting.calibration_list import shown_calibrations
from tritrack.starting.run_list import MOST_SHOWN, RunFiles, found_runs, picture_of, shown_runs

EVERY_S: Final = 2.0
"""Interval at which runs, calibrations and cameras are looked for, seconds."""
PREVIEW_S: Final = 15.0
"""Seconds without a request for a picture after which the cameras are closed."""


class StartLists:
    """What is in the folder of the runs, and the cameras of this machine.

    Args:
        runs: The folder of the runs.
        videos: They play as cameras.
        aside: Draws the pictures.
    """

    def __init__(self, runs: Path, videos: Sequence[Path], aside: Aside) -> None:
        self._runs, self._videos, self._aside = runs, videos, aside
        self._cameras: list[FoundCamera] = []
        self._previews = Previews()
        self._drawn: dict[str, float] = {}
        """Of which runs a picture was tried, and of which change."""
        self.pictures: dict[str, bytes] = {}
        """JPEGs of runs by name."""
        self._due_s = 0.0

    @property
    def sources(self) -> dict[str, Source]:
        """Of the cameras, by their ids."""
        return {each.camera: each.source for each in self._cameras}

    @property
    def shows(self) -> bool:
        """Whether the cameras are open for their pictures alone, not for the board."""
        return self._previews.on and not self._previews.watching

    @property
    def has_devices(self) -> bool:
        """Whether some are no files: those can be opened by one program alone."""
        return not all(is_recorded(each.source) for each in self._cameras)

    def camera_jpeg(self, camera: str) -> bytes | None:
        """The newest picture of a camera; from any thread."""
        return self._previews.jpeg(camera)

    def hurry(self) -> None:
        """Look again at once."""
        self._due_s = 0.0

    def look(self, on: bool) -> None:
        """Open the cameras, or close them."""
        self.hurry()
        if on:
            self._cameras = cameras_of(self._videos)
            self._previews.open(self._cameras)
        else:
            self._previews.close()

    def watch(self, cameras: Sequence[str], folder: Path) -> tuple[Path, ...]:
        """Look for the board in these cameras, in none: no longer; returns what was seen of it."""
        self.hurry()
        there = {each.camera: each for each in self._cameras}
        videos = self._previews.unwatch()
        if cameras:
            self._previews.watch([there[camera] for camera in cameras], folder)
        return videos

    def turn(self, page: StartPage) -> None:
        """Show what has changed, every other second."""
        now_s = time.monotonic()
        if now_s < self._due_s:
            return
        self._due_s = now_s + EVERY_S
        runs = found_runs(self._runs)
        self._draw(runs)
        pictured = {name: self._drawn[name] for name in self.pictures}
        page.show(shown_runs(runs, pictured))
        page.show(shown_calibrations(self._runs))
        page.show(shown_recordings(self._runs))
        if (
            self._previews.on
            and not self._previews.watching
            and now_s - self._previews.looked_s > PREVIEW_S
        ):
            self._previews.close()
        if not self._previews.on:
            self._cameras = cameras_of(self._videos)
        page.show(self._previews.shown(self._cameras))

    def close(self) -> None:
        """Close the cameras."""
        self._previews.close()

    def _draw(self, runs: Sequence[RunFiles]) -> None:
        """Have the newest run without a picture drawn, one at a time."""
        there = {run.folder.name for run in runs}
        for name in [name for name in self._drawn if name not in there]:
            self._drawn.pop(name)
            self.pictures.pop(name, None)
        due = [
            run for run in runs[:MOST_SHOWN] if self._drawn.get(run.folder.name) != run.changed_s
        ]
        if due and self._aside.is_free:
            self._aside.ask(_drawing(due[0]), self._keep(due[0]))

    def _keep(self, run: RunFiles) -> Callable[[bytes | None], None]:
        def keep(jpeg: bytes | None) -> None:
            self._drawn[run.folder.name] = run.changed_s
            self.pictures.pop(run.folder.name, None)
            if jpeg is not None:
                self.pictures[run.folder.name] = jpeg
            self.hurry()

        return keep


def _drawing(run: RunFiles) -> Callable[[Decoder], bytes | None]:
    """Draws the picture of a run; one that cannot be read has none."""

    def draw(decoder: Decoder) -> bytes | None:
        try:
            return picture_of(run, decoder)
        except PastRunError:
            return None

    return draw
