"""From any video of one static camera to an animation: the thesis's use (T1)."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np
from rich.console import Console

from animator.take import take_of
from animator.video_codec import H264
from common.config.config_file import load
from common.config.part_settings import CameraSettings, SettingsError
from common.config.settings import Settings
from common.method import METHODS
from common.notes.notes import Notes
from common.notes.notes_file import NotesError, load_notes, notes_path
from common.npz_file import Arrays, Facts
from common.video.clip_sources import (
    CLIP_CAMERAS,
    ClipError,
    first_camera,
    refuse_no_source,
    sources_of,
)
from common.video.clips import open_clip
from common.video.decoding import Decoder
from common.video.pictures import DecoderDied, Undecodable
from runtime.offline.video_tracking import Followed, Heard, VideoInput, follow_clip, follow_masks
from runtime.overrides import overridden
from runtime.steps.frame_cache import FrameCache, Told
from runtime.store.clip_paths import ClipsFailed
from runtime.store.other_run import OtherRun, RunOf, refuse_other, run_of
from runtime.store.pose_arrays import mapped_poses
from runtime.store.runs import belief_facts, write_run
from runtime.terminal import Tell, bar, by_pass, complain, say, warn
from runtime.unfinished.message_file import writing
from runtime.unfinished.resuming import Begun, Wanted, done_before, resumable
from runtime.unfinished.unfinished_run import CannotResume
from runtime.unfinished.work import InMemory, Work
from runtime.warming.first_compilation import compiling_beside
from tritrack.single.animation_files import write_files
from tritrack.single.ledger import facts_of, ledger
from tritrack.single.mask_file import MaskFileError, MaskSequence, is_mask_file, read_masks
from tritrack.single.overlay_video import write_overlay
from viewer.room.background_source import LOOKED_AT, background_of_film

NO_BACKGROUND: Final = Path("none")
PASSES: Final = ("learning the room", "cutting out", "posing", "drawing")
"""The passes over a video, one after the other."""
UNUSABLE: Final = (
    *(SettingsError, ClipError, DecoderDied, Undecodable),
    *(MaskFileError, NotesError, CannotResume, OtherRun),
)
"""Errors of one video that do not affect the others."""


class Given(NamedTuple):
    """The user's options for all videos."""

    notes: Path | None = None
    """Replaces the notes beside each."""
    background: Path | None = None
    """A picture of the scene without a person, or NO_BACKGROUND."""
    resume: bool = False
    """Resume interrupted runs, and skip complete ones."""
    force: bool = False
    """Overwrite runs of other videos."""
    landmarks: str | None = None
    """Source of the landmarks, in place of the settings'."""


class Job(NamedTuple):
    """One video, or one sequence of masks."""

    path: Path
    settings: Settings
    masks: MaskSequence | None
    notes: Notes


def single_all(
    videos: Sequence[Path],
    out: Path,
    given: Given,
    settings: Settings,
    console: Console,
) -> Facts:
    """Track the person in video after video, write a run folder for each, and report it.

    With several videos, an unusable one is reported and skipped.

    Args:
        videos: Videos of one camera, clip folders, settings files, or masks (`mask_file`).
        out: Gets a folder for each.
        given: The user's options for all of them.
        settings: Mode, size and everything else that a settings file does not set.
        console: Shows progress, warnings and errors.

    Raises:
        SettingsError, ClipError, DecoderDied, Undecodable, MaskFileError, NotesError: When the only
            video cannot be used.
        ClipsFailed: At the end, when any of several could not be used.
        RunError, VideoError: When the results cannot be written.
    """
    done: Facts = {}
    with compiling_beside(), Decoder() as decoder, bar(console) as progress:
        for path, begun in by_pass(progress, videos, PASSES):
            name = name_of(path)
            try:
                _refuse_the_same(path, out / name, name in done)
                job = job_of(path, given, settings)
                _tell_of_two(job, console)
                if not given.force:
                    refuse_other(out / name, _run_of(job))
                wanted = Wanted(out / name, job.settings, {"the notes": job.notes}, given.resume)
                before = None if job.masks else done_before(wanted, console)
                done[name] = before or _kept(job, wanted, decoder, console, begun)
                if before is None:
                    say(console, line_of(name, done[name]))
            except UNUSABLE as error:
                if len(videos) == 1:
                    raise
                complain(console, str(error))
    if len(done) < len(videos):
        raise ClipsFailed(
            f"{len(videos) - len(done)} of {len(videos)} videos could not be followed"
        )
    return {"clips": done}


def _refuse_the_same(path: Path, folder: Path, there: bool) -> None:
    if there:
        raise ClipError(f"{path} would be written to {folder} too: rename it")


def _tell_of_two(job: Job, console: Console) -> None:
    """Which of two cameras is tracked."""
    if len(sources_of(job.settings)) > 1:
        say(
            console,
            f"{job.path}: camera 1 alone is followed; all of them: tritrack track {job.path}",
        )


def name_of(path: Path) -> str:
    """Name of the run folder: the video's, the folder's, or that of the sequence of masks."""
    if is_mask_file(path):
        file_name, _, wanted = path.name.partition("#")
        return wanted or Path(file_name).stem
    return path.resolve().name if path.is_dir() else path.stem


def job_of(path: Path, given: Given, settings: Settings) -> Job:
    """The input for a path of the command line.

    Raises:
        SettingsError, ClipError, MaskFileError, NotesError: When it cannot be read, or names no
            source.
    """
    if is_mask_file(path):
        masks = read_masks(path)
        return Job(path, settings, masks, load_notes(given.notes) if given.notes else Notes())
    if path.is_dir() or path.suffix == ".toml":
        own = load(path)
        refuse_no_source(own, path)
        beside = path / "cam1" if path.is_dir() else path
    else:
        cameras = {CLIP_CAMERAS[0]: CameraSettings(source=str(path))}
        own = msgspec.structs.replace(settings, cameras=cameras)
        beside = path
    without = "none" if given.background == NO_BACKGROUND else None
    wanted = settings.mode, settings.size, given.landmarks, None, without
    settings = overridden(own, *wanted)
    if given.background is not None and without is None:
        name = first_camera(settings)
        camera = settings.cameras.get(name, CameraSettings())
        camera = msgspec.structs.replace(camera, background=str(given.background))
        settings = msgspec.structs.replace(settings, cameras={**settings.cameras, name: camera})
    file = given.notes or notes_path(beside)
    return Job(path, settings, None, load_notes(file) if given.notes or file.exists() else Notes())


def _run_of(job: Job) -> RunOf:
    """Its videos; a clip folder's second one does not belong to them."""
    films = [view.source for view in sources_of(job.settings)][:1]
    return run_of("single", [str(job.path)] if job.masks is not None else films)


def _kept(
    job: Job, wanted: Wanted, decoder: Decoder, console: Console, begun: Callable[[str], Tell]
) -> Facts:
    """Track one video; intermediate results are on disk meanwhile."""
    if job.masks is not None:
        return follow(job, wanted.folder, decoder, console, begun, Begun(InMemory(), {}))
    with resumable(wanted, console) as run:
        return follow(job, wanted.folder, decoder, console, begun, run)


def follow(
    job: Job,
    folder: Path,
    decoder: Decoder,
    console: Console,
    begun: Callable[[str], Tell],
    run: Begun,
) -> Facts:
    """Track one video and write its run folder; returns its summary, and the overlay.

    Poses are written first, so that they are kept whatever happens to pictures and videos.

    Raises:
        ClipError, DecoderDied: When it cannot be used.
        RunError, VideoError: When the folder cannot be written.
    """
    found = _found(job, decoder, begun, run.work)
    with writing(folder), mapped_poses(found.bodies, folder) as arrays:
        facts = {
            **found.facts,
            "frames_with_pose": sum(bool(body.joints_m) for body in found.bodies),
            **belief_facts(found.bodies),
            "effort": facts_of(ledger(take_of(arrays, turn=found.turn), job.notes)),
            "notes": msgspec.to_builtins(job.notes),
            **_run_of(job).facts,
            **run.facts,
        }
        write_run(folder, found.bodies, job.settings, facts)
        odd, sure = write_files(folder, arrays, found.background), mean_confidence(arrays)
    film = write_overlay(found, folder / "overlay", decoder, begun("drawing"))
    for warning in (*facts["warnings"], *odd):
        warn(console, f"{folder.name}: {warning}")
    shown = {"overlay": str(film.path), "overlay_codec": film.codec.name}
    return {**facts, "frames": len(found.bodies), "confidence": sure, **shown}


def _found(job: Job, decoder: Decoder, begun: Callable[[str], Tell], work: Work) -> Followed:
    if job.masks is not None:
        return follow_masks(job.masks.name, job.masks.reports, job.settings, begun("posing"))
    clip = open_clip(job.settings, decoder, (1,))
    view, frame_cache = clip.views[0], FrameCache(decoder, due=clip.views[0].frames)
    looking = Told(frame_cache, min(view.frames, LOOKED_AT), begun("learning the room"))
    background = background_of_film(view, job.settings.silhouette, looking)
    film, method = VideoInput(clip, background, job.notes), METHODS[job.settings.mode]
    heard = Heard(begun("cutting out"), begun("posing"), work)
    return follow_clip(film, job.settings, method, frame_cache, heard)


def mean_confidence(arrays: Arrays) -> float:
    """Mean confidence of the joints in the frames with a pose; 0 where there is none."""
    posed = np.isfinite(arrays["joints_m"]).all(axis=(1, 2))
    return round(float(arrays["confidence"][posed].mean()), 3) if posed.any() else 0.0


def line_of(name: str, facts: Facts) -> str:
    """Source, quality and main file of a run, in one line."""
    share = facts["frames_with_pose"] / max(1, facts["frames"])
    believed = facts.get("believed")
    return (
        f"{name}: a pose in {facts['frames_with_pose']} of {facts['frames']} frames ({share:.0%})"
        + (f", believed in {believed:.0%}" if believed is not None else "")
        + f", mean confidence {facts['confidence']:.2f}; open {facts['overlay']} "
        f"({_codec_words(facts['overlay_codec'])})"
    )


def _codec_words(name: str) -> str:
    """An overlay's codec, and how to get one that browsers play."""
    return name if name == H264.name else f"{name}: pip install 'tritrack[video]' for browsers"
