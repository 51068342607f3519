"""The runs of a folder: what each was, how well it went, its picture and its files."""

import json
import os
import time
from collections.abc import Mapping
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, NamedTuple
from urllib.parse import quote

import cv2
import numpy as np

from animator.overlay import draw_stick
from animator.start.sections import Runs, ShownRun
from common.body.body import Vector
from common.config.picture_size import size_of, size_within, working_size
from common.npz_file import Facts
from common.video.decoding import Decoder
from common.video.pictures import DecoderDied, Image, Size, Undecodable, Wanted
from runtime.offline.rig_check import clock_words
from runtime.store.other_run import RUN_OF
from runtime.store.past_run import is_run, open_run
from runtime.store.run_exports import EXPORTS, PAGES

MOST_SHOWN: Final = 100
MOST_FILE_BYTES: Final = 1 << 29
"""A larger file is not offered: the page reads a file whole."""
PICTURE: Final = (320, 240)
"""Bound of a run's picture, pixels."""
OFFERED: Final = (
    *(*PAGES, "keyframes.bvh", *EXPORTS),
    *("poses.npz", "summary.json", "posture.json", "recording.mcap"),
)
"""Files of a run that may be downloaded; exports of one of several people besides."""
MOST_PAPER: Final = 4
"""Largest side of the paper behind a body, over that of the run's working picture: a joint beside
the camera lies far outside."""
RECORDING: Final = "recording.mcap"
WORDS: Final = {"single": "one camera", "replay": "replayed"}


class RunFiles(NamedTuple):
    """A run and what is read of it."""

    folder: Path
    changed_s: float
    """When its summary was written."""
    summary: Facts


def run_folder(runs: Path, name: str) -> Path | None:
    """A run by its name; None where there is none, or the name would lead elsewhere."""
    folder = runs / name
    if not name or name.startswith(".") or name != folder.name:
        return None
    with suppress(OSError):  # a folder that we may not read, or too long a name
        return folder if not folder.is_symlink() and folder.is_dir() and is_run(folder) else None
    return None


def run_file(runs: Path, name: str, file: str) -> Path | None:
    """A file of a run that may be downloaded; None where there is none."""
    folder = run_folder(runs, name)
    if folder is None or file not in files_of(folder):
        return None
    return folder / file


def files_of(folder: Path) -> dict[str, int]:
    """The files of a run that may be downloaded, with their bytes; pages first."""
    found = {}
    with suppress(OSError):  # deleted meanwhile
        for path in folder.iterdir():
            stem, _, person = path.stem.partition("_person")
            whole = f"{stem}{path.suffix}" if person.isdecimal() else path.name
            if whole in OFFERED and path.is_file() and not path.is_symlink():
                found[path.name] = path.stat().st_size
    small = [name for name, size in found.items() if size <= MOST_FILE_BYTES]
    return {name: found[name] for name in sorted(small, key=lambda n: (n not in PAGES, n))}


def found_runs(runs: Path) -> list[RunFiles]:
    """The runs of a folder, newest first; one that is being written is left out."""
    found = []
    for path in runs.iterdir() if runs.is_dir() else ():
        summary = path / "summary.json"
        if run_folder(runs, path.name) is None or not summary.is_file():
            continue
        try:
            told, changed_s = json.loads(summary.read_text()), summary.stat().st_mtime
        except (OSError, ValueError, RecursionError):
            continue
        if isinstance(told, dict):
            found.append(RunFiles(path, changed_s, told))
    return sorted(found, key=lambda run: -run.changed_s)


def shown_runs(found: list[RunFiles], pictures: Mapping[str, float]) -> Runs:
    """In the form for browsers.

    Args:
        found: Newest first.
        pictures: Of which runs there are pictures, and of which change.
    """
    shown = [shown_run(run, pictures.get(run.folder.name, 0.0)) for run in found[:MOST_SHOWN]]
    return Runs(shown, len(found) - len(shown))


def shown_run(run: RunFiles, pictured: float = 0.0) -> ShownRun:
    """One of them."""
    name, told = run.folder.name, run.summary
    at = f"run/{quote(os.fsencode(name))}"
    files = files_of(run.folder)
    believed, frames = told.get("believed"), told.get("frames")
    return ShownRun(
        name=name,
        picture=f"{at}/picture.jpg?{pictured:.0f}" if pictured else "",
        when=time.strftime("%Y-%m-%d %H:%M", time.localtime(run.changed_s)),
        what=what_of(told),
        frames=frames if isinstance(frames, int) else 0,
        believed=float(believed) if isinstance(believed, int | float) else None,
        notes=notes_of(told),
        files=tuple((f"{at}/{quote(file)}", file, size) for file, size in files.items()),
        replay=_why_no_replay(files, told),
        retouch=_why_no_retouch(told),
    )


def what_of(summary: Mapping[str, Any]) -> str:
    """What a run was: how it was made, of which videos."""
    command, footage = made_by(summary)
    films = [Path(film).name for film in footage]
    word = WORDS.get(command, command)
    if command == "track":
        word = f"{len(films)} cameras" if len(films) > 1 else "one camera"
    return f"{word}: {', '.join(films)}" if films else word


def made_by(summary: Mapping[str, Any]) -> tuple[str, list[str]]:
    """The command of a run and its videos; an older summary does not tell."""
    told = summary.get(RUN_OF)
    if not isinstance(told, Mapping) or not isinstance(told.get("footage"), list):
        return "live", []
    return str(told.get("command")), [str(film) for film in told["footage"]]


def notes_of(summary: Mapping[str, Any]) -> tuple[str, ...]:
    """Warnings of a run, the advice on its calibration, and how late camera 2 was."""
    warnings, trust = summary.get("warnings"), summary.get("trust")
    notes = [str(each) for each in warnings] if isinstance(warnings, list) else []
    if isinstance(trust, Mapping) and trust.get("advice"):
        notes.append(str(trust["advice"]))
    with suppress(KeyError, TypeError, ValueError, AttributeError):  # of another make
        notes += clock_words(dict(summary))
    return tuple(dict.fromkeys(notes))


def _why_no_replay(files: Mapping[str, int], summary: Mapping[str, Any]) -> str:
    if RECORDING in files:
        return ""
    if made_by(summary)[0] == "single":
        return "a video of one camera has an overlay instead: see its files"
    return "not recorded: add --record to the command"


def _why_no_retouch(summary: Mapping[str, Any]) -> str:
    if find_spec("viser") is None or find_spec("tomlkit") is None:
        return "needs: pip install 'tritrack[page]'"
    films = made_by(summary)[1]
    return "" if films and _is_there(films[0]) else "its video is not there"


def _is_there(film: str) -> bool:
    with suppress(OSError, ValueError):  # a path that this system cannot have
        return Path(film).is_file()
    return False


def picture_of(run: RunFiles, decoder: Decoder) -> bytes | None:
    """A JPEG of a run: the body in the middle of its frames, over the video's frame if that is
    there; None where there is no pose.

    Raises:
        PastRunError: When it cannot be read.
    """
    poses = open_run(run.folder).poses
    posed = np.isfinite(poses["joints_px"][:, 0]).all(axis=(1, 2))
    rows = np.flatnonzero(posed & (poses["confidence"].mean(axis=1) > 0))
    rows = rows if len(rows) else np.flatnonzero(posed)
    if not len(rows):
        return None
    row = int(rows[len(rows) // 2])
    joints_px, sure = poses["joints_px"][row, 0], poses["confidence"][row]
    bound = bound_of(run.summary)
    image, width_px = _frame_or_paper(run, decoder, int(poses["frame"][row]), joints_px, bound)
    draw_stick(image, joints_px * (image.shape[1] / width_px), sure)
    return bytes(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 80])[1])


def bound_of(summary: Mapping[str, Any]) -> Size:
    """The bound of a run's working picture, by its settings."""
    settings = summary.get("settings")
    told = settings.get("size") if isinstance(settings, Mapping) else None
    try:
        return size_of(str(told))
    except ValueError:
        return PICTURE


def _frame_or_paper(
    run: RunFiles, decoder: Decoder, frame: int, joints_px: Vector, bound: Size
) -> tuple[Image, int]:
    """The frame, else paper on which the body fits; and the width of the working picture."""
    films = made_by(run.summary)[1]
    if films and _is_there(films[0]):
        try:
            info = decoder.probe(films[0])
            size = (info.width, info.height)
            wanted = Wanted(start=max(0, frame))
            shown = decoder.frames(films[0], size_within(size, PICTURE), wanted)
            image = next(shown).picture.copy()
            shown.close()
            return image, working_size(size, bound)[0]
        except (Undecodable, DecoderDied, StopIteration):
            pass
    low = np.clip(joints_px.max(axis=0) + 8, bound, np.multiply(bound, MOST_PAPER))
    width, height = int(low[0]), int(low[1])
    return np.full((height, width, 3), 245, np.uint8), width
