"""The files beside the runs: a job's own videos, and what is cleaned, deleted and served."""

import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final
from urllib.parse import unquote

from animator.page.page_server import POLICY, REPORT_POLICY, File
from common.atomic_file import unwritten
from tritrack.starting.calibration_list import calibration_file
from tritrack.starting.job_plan import CLIPS, Plan, PlanError
from tritrack.starting.run_list import run_file, run_folder

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
            try:
                os.link(source, target)
            except OSError:
                shutil.copy2(source, target)
        except OSError as error:
            raise PlanError(unwritten(target, error, "drop the files again")) from error
    if plan.report is not None:
        plan.report.parent.mkdir(parents=True, exist_ok=True)


def clean(runs: Path, is_used: Callable[[Path], bool]) -> None:
    """Remove videos and settings that belong to no run any more.

    Args:
        runs: The folder of the runs.
        is_used: Whether a job needs a path.
    """
    for place_of in (CLIPS, SETTINGS):
        for path in (runs / place_of).glob("*"):
            if (runs / path.stem).is_dir() or (runs / path.name).is_dir() or is_used(path):
                continue
            remove(path)


def delete_run(runs: Path, name: str) -> bool:
    """Delete a run with its own videos; False where there is no such run.

    Raises:
        PlanError: When something of it is left.
    """
    folder = run_folder(runs, name)
    if folder is None:
        return False
    for path in (folder, runs / CLIPS / name, runs / SETTINGS / f"{name}.toml"):
        remove(path)
        if path.exists():
            raise PlanError(f"a part of {path} is left: see that you may write it, and delete it")
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
