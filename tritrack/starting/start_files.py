"""The files beside the runs: a job's own videos, and what is cleaned, deleted and served."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final
from urllib.parse import unquote

from animator.page.page_server import POLICY, REPORT_POLICY, File
from common.atomic_file import unwritten
from common.video.camera_file import write_times
from tritrack.starting.calibration_list import calibration_file
from tritrack.starting.job_plan import CALIBRATIONS, CLIPS, Plan, PlanError
from tritrack.starting.run_list import found_runs, made_by, run_file, run_folder
from tritrack.starting.uploads import link_or_copy

SETTINGS: Final = ".settings"
"""Folder of the settings of live runs that the page began."""
PICTURE: Final = "picture.jpg"
LOADED: Final = File("application/octet-stream", b"", POLICY)
"""How a browser gets what it only loads."""
SHOWN: Final = {
    ".html": File("text/html", b"", REPORT_POLICY),
    ".mp4": File("video/mp4", b"", POLICY),
}
"""How it gets what it shows, by the suffix."""


def place(plan: Plan) -> None:
    """Put a plan's files where its command reads them: as links, else copies.

    Raises:
        PlanError: When one cannot be written, or is gone.
    """
    for source, target in plan.placed:
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.unlink(missing_ok=True)
            link_or_copy(source, target)
        except OSError as error:
            raise PlanError(unwritten(target, error, "drop the files again")) from error
    if plan.times_s:
        videos = [to for _, to in plan.placed]
        pairs = zip(videos, plan.times_s, strict=False)
        write_times(videos[0].parent, {video.stem: times_s for video, times_s in pairs})
    for word in plan.arguments:
        if Path(word).parent.name == CALIBRATIONS:
            Path(word).parent.mkdir(parents=True, exist_ok=True)


def clean(runs: Path, is_used: Callable[[Path], bool]) -> None:
    """Remove videos and settings that belong to no run any more.

    A run keeps the videos that its summary names, whatever its folder is called by now.

    Args:
        runs: The folder of the runs.
        is_used: Whether a job needs a path.
    """
    named = {clip_name(video) for run in found_runs(runs) for video in made_by(run.summary)[1]}
    for place_of in (CLIPS, SETTINGS):
        for path in (runs / place_of).glob("*"):
            is_of_run = (runs / path.stem).is_dir() or (runs / path.name).is_dir()
            if not (is_of_run or path.name in named or is_used(path)):
                remove(path)


def clip_name(video: str) -> str:
    """The name of the folder of a run's own video; "": it is not among those.

    By the path's end alone: a folder of runs may be reached by a link, or be moved.
    """
    parts = Path(video).parts
    return parts[parts.index(CLIPS) + 1] if CLIPS in parts[:-1] else ""


def delete_run(runs: Path, name: str) -> bool:
    """Delete a run; False where there is no such run. `clean` then removes its videos.

    Raises:
        PlanError: When something of it is left.
    """
    folder = run_folder(runs, name)
    if folder is None:
        return False
    remove(folder)
    if folder.exists():
        raise PlanError(f"a part of {folder} is left: see that you may write it, and delete it")
    return True


def remove(path: Path) -> None:
    """Remove a file or folder, where it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def served(
    path: str,
    runs: Path,
    pictures: Mapping[str, bytes],
    camera_jpeg: Callable[[str], bytes | None],
) -> File | None:
    """The file for a path in a request; None where there is none, or none that may be served.

    Args:
        path: As /run/NAME/FILE, /calibration/FILE or /camera/ID.jpg.
        runs: The folder of the runs.
        pictures: JPEGs of runs by name.
        camera_jpeg: Gives a camera's newest picture.
    """
    parts = unquote(path, errors="surrogateescape").split("/")[1:]
    jpeg, found = None, None
    if len(parts) == 3 and parts[0] == "run" and parts[2] == PICTURE:
        jpeg = pictures.get(parts[1])
    elif len(parts) == 3 and parts[0] == "run":
        found = run_file(runs, parts[1], parts[2])
    elif len(parts) == 2 and parts[0] == "calibration":
        found = calibration_file(runs, parts[1])
    elif len(parts) == 2 and parts[0] == "camera":
        jpeg = camera_jpeg(parts[1].removesuffix(".jpg"))
    if jpeg is not None:
        return File("image/jpeg", jpeg)
    try:
        if found is None:
            return None
        return SHOWN.get(found.suffix, LOADED)._replace(content=found.read_bytes())
    except OSError:
        return None
