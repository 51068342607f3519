"""Any video of one camera that stands still, to an animation: the thesis's way (T1)."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from animator.bvh import NoMotion, bvh_text, steady
from animator.film import filming
from animator.inbetween import at, between, key_frames
from animator.overlay import overlay
from animator.take import take_of
from common.atomic_file import replacing
from common.config import CameraSettings, Settings, SettingsError, load
from common.method import METHODS
from common.notes.notes import Notes
from common.notes.notes_file import NotesError, load_notes, notes_path
from common.raster.silhouette_report import unpack
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from common.video.decoding import Decoder, DecoderDied, Undecodable
from common.video.frame_cache import Reel
from tritrack.offline.film_tracking import Film, Followed, follow_clip, follow_masks
from tritrack.single.angle_plot import angle_plot
from tritrack.single.ledger import facts_of, ledger
from tritrack.single.mask_file import MaskFileError, MaskSequence, is_mask_file, read_masks
from tritrack.store.clip_paths import ClipsFailed
from tritrack.store.runs import RunError, poses, write_run
from tritrack.terminal import Tell, bar, by_share, complain, json_text, warn
from viewer.background.background import Background
from viewer.background.background_source import background_of_film

FLAG: Final = (0, 0, 255)
"""Pixels that were never uncovered are hatched in this colour."""


class Job(NamedTuple):
    """One video, or one sequence of masks."""

    path: Path
    settings: Settings
    masks: MaskSequence | None
    notes: Notes


def single_all(
    videos: Sequence[Path],
    out: Path,
    notes: Path | None,
    settings: Settings,
    console: Console,
) -> dict[str, Any]:
    """Follow the person in video after video, and write a run folder for each.

    A video that cannot be used is said and left out; the others are followed.

    Args:
        videos: Videos of one camera, clip folders, settings files, or masks (`mask_file`).
        out: Gets a folder for each.
        notes: The user's inputs instead of those beside the video.
        settings: Mode, size and whatever else a settings file does not say.
        console: For progress, warnings and errors.

    Raises:
        ClipsFailed: At the end, when any video could not be used, or shows nobody: what it shows
            is written all the same.
        RunError, FilmError: When the results cannot be written.
    """
    done: dict[str, Any] = {}
    with Decoder() as decoder, bar(console) as progress:
        for path, tell in by_share(progress, videos, "following"):
            name = name_of(path)
            if name in done:
                complain(console, f"{path} would be written to {out / name} too: rename it")
                continue
            try:
                job = job_of(path, notes, settings)
                done[name] = follow(job, out / name, decoder, console, tell)
            except (
                *(SettingsError, ClipError, DecoderDied, Undecodable),
                *(MaskFileError, NotesError),
            ) as error:
                complain(console, str(error))
    if len(done) < len(videos):
        raise ClipsFailed(
            f"{len(videos) - len(done)} of {len(videos)} videos could not be followed"
        )
    _refuse_the_empty(done, out)
    return {"clips": done}


def _refuse_the_empty(done: dict[str, Any], out: Path) -> None:
    empty = [name for name, facts in done.items() if not facts["frames_with_pose"]]
    if empty:
        raise ClipsFailed(
            f"nobody was found in {len(empty)} of {len(done)} videos: look for an outline in "
            f"{out / empty[0] / 'overlay.avi'}; without one, they stand still or are too small"
        )


def name_of(path: Path) -> str:
    """Name of the run folder: the video's, the folder's, or that of the sequence of masks."""
    if is_mask_file(path):
        file_name, _, wanted = path.name.partition("#")
        return wanted or Path(file_name).stem
    return path.resolve().name if path.is_dir() else path.stem


def job_of(path: Path, notes: Path | None, settings: Settings) -> Job:
    """What a path of the command line stands for.

    Raises:
        SettingsError, MaskFileError, NotesError: When it cannot be read.
    """
    if is_mask_file(path):
        masks = read_masks(path)
        return Job(path, settings, masks, load_notes(notes) if notes else Notes())
    if path.is_dir() or path.suffix == ".toml":
        own = load(path)
        settings = msgspec.structs.replace(own, mode=settings.mode, size=settings.size)
        beside = path / "cam1" if path.is_dir() else path
    else:
        settings = msgspec.structs.replace(settings, camera_1=CameraSettings(source=str(path)))
        beside = path
    file = notes or notes_path(beside)
    return Job(path, settings, None, load_notes(file) if notes or file.exists() else Notes())


def follow(
    job: Job, folder: Path, decoder: Decoder, console: Console, tell: Tell
) -> dict[str, Any]:
    """Follow one video and write its run folder; what the summary tells of it.

    Half of the work is done when every frame was looked at; later each is drawn.

    Raises:
        ClipError, DecoderDied: When it cannot be used.
        RunError, FilmError: When the folder cannot be written.
    """
    if job.masks is not None:
        found = follow_masks(job.masks.name, job.masks.reports, job.settings)
    else:
        clip = open_clip(job.settings, decoder, (1,))
        background = background_of_film(clip.views[0], job.settings.silhouette, Reel(decoder))
        film, method = Film(clip, background, job.notes), METHODS[job.settings.mode]
        found = follow_clip(film, job.settings, method, decoder, lambda share: tell(share / 2))
    arrays = poses(found.bodies)
    facts = {
        **found.facts,
        "frames_with_pose": sum(bool(body.joints_m) for body in found.bodies),
        "effort": facts_of(ledger(take_of(arrays), job.notes)),
        "notes": msgspec.to_builtins(job.notes),
    }
    write_run(folder, found.bodies, job.settings, facts)
    _write_bytes(folder / "angles.png", angle_plot(arrays))
    if found.background is not None:
        _write_picture(folder / "background.png", marked(found.background))
    odd = _animate(folder, arrays)
    with filming(folder / "overlay.avi", found.rate_hz) as writer:
        for n, picture in enumerate(overlaid(found, decoder), 1):
            writer.write(picture)
            tell(0.5 + 0.5 * n / len(found.reports))
    for warning in (*facts["warnings"], *odd):
        warn(console, f"{folder.name}: {warning}")
    return facts


def marked(background: Background) -> NDArray[np.uint8]:
    """The background, what was never uncovered hatched."""
    picture = np.clip(np.rint(background.centre), 0, 255).astype(np.uint8)
    rows, columns = np.indices(background.uncertain.shape)
    picture[background.uncertain & ((rows + columns) % 4 < 2)] = FLAG
    return picture


def overlaid(found: Followed, decoder: Decoder) -> Iterator[NDArray[np.uint8]]:
    """Every frame with its silhouette and stick, the lifted body beside it."""
    for report, body, picture in zip(
        found.reports, found.bodies, _pictures(found, decoder), strict=False
    ):
        posed = bool(body.joints_m)
        nothing = np.full((15, 3), np.nan)
        yield overlay(
            picture,
            unpack(report),
            np.array(body.joints_px[0]) if posed else nothing[:, :2],
            found.to_camera(np.array(body.joints_m)) if posed else nothing,
            np.array(body.confidence) if posed else np.zeros(15),
            f"frame {body.frame}  S {body.score[0]:.2f}  {body.status}",
        )


def _pictures(found: Followed, decoder: Decoder) -> Iterator[NDArray[np.uint8]]:
    """The frames that were followed; of masks: nothing but paper."""
    if found.clip is None:
        paper = np.full((found.size[1], found.size[0], 3), 255, np.uint8)
        for _ in found.reports:
            yield paper
        return
    view = found.clip.views[0]
    for decoded in decoder.frames(view.source, view.size, found.clip.every):
        yield decoded.picture


def _animate(folder: Path, arrays: dict[str, Any]) -> list[str]:
    """Write the animation and that of the key frames alone; what stood in the way."""
    joints_m, time_s = arrays["joints_m"], arrays["time_s"]
    try:
        skeleton, motion, step_s = steady(joints_m, time_s)
    except NoMotion as error:
        return [f"there is no animation: {error}"]
    posed = np.flatnonzero(np.isfinite(joints_m).all(axis=(1, 2)))
    rows = np.rint((time_s[posed] - time_s[posed[0]]) / step_s).astype(np.int64)
    clarity = np.full(len(motion.root_m), np.nan)
    clarity[rows] = arrays["confidence"][posed].mean(axis=1)
    keys = key_frames(clarity)
    drawn = between(keys, at(motion, keys), np.arange(len(clarity)))
    frame_of = dict(zip(rows.tolist(), arrays["frame"][posed].tolist(), strict=True))
    told = {"frames": [frame_of[key] for key in keys.tolist()], "of": len(clarity)}
    try:
        _write_text(folder / "body.bvh", bvh_text(skeleton, motion, step_s))
        _write_text(folder / "keyframes.bvh", bvh_text(skeleton, drawn, step_s))
        _write_text(folder / "keyframes.json", json_text(told) + "\n")
    except OSError as error:
        raise RunError(f"cannot write {folder}: {error.strerror}; free some space") from error
    return []


def _write_text(path: Path, text: str) -> None:
    with replacing(path) as new:
        new.write_text(text, "utf-8")


def _write_picture(path: Path, picture: NDArray[np.uint8]) -> None:
    _write_bytes(path, cv2.imencode(".png", picture)[1].tobytes())


def _write_bytes(path: Path, content: bytes) -> None:
    try:
        with replacing(path) as new:
            new.write_bytes(content)
    except OSError as error:
        raise RunError(f"cannot write {path}: {error.strerror}; free some space") from error
