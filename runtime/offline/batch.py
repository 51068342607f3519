"""Clip after clip tracked in lock-step, with a run folder for each."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, Literal, NamedTuple

import msgspec
from rich.console import Console

from common.bus.messages import Body, ScaleSource, View, ViewerNumber
from common.config import config_file
from common.config.part_settings import SettingsError
from common.config.settings import Settings
from common.method import Mode
from common.npz_file import Facts
from common.video.clip_facts import Clip, camera_names, whole_rig
from common.video.clip_sources import ClipError, refuse_no_source, sources_of
from common.video.pictures import DecoderDied, Undecodable
from integrator.frame_numbers import frame_times
from runtime.offline.lockstep import Decoders, Tracked, measured_before, track_clip
from runtime.offline.performance import Watch
from runtime.offline.rig_check import clock_words
from runtime.overrides import overridden
from runtime.store.clip_paths import ClipsFailed, run_names, without_plain_files
from runtime.store.other_run import OtherRun, RunOf, refuse_other, run_of
from runtime.store.recording import Head, recording_to, refuse_without_library
from runtime.store.runs import belief_facts, write_run
from runtime.terminal import Tell, bar, by_share, complain, say, warn
from runtime.unfinished.resuming import Wanted, done_before, resumable
from runtime.unfinished.unfinished_run import CannotResume
from runtime.unfinished.work import Course, Kept
from runtime.warming.first_compilation import compiling_beside

KEPT_AS_IT_IS: Final = (CannotResume, OtherRun)
"""An error that keeps one clip's run folder from being written."""


class Asked(NamedTuple):
    """The user's options for all clips; None leaves their settings."""

    mode: Mode | None = None
    size: str | None = None
    landmarks: str | None = None
    """Source of the landmarks."""
    views: tuple[ViewerNumber, ...] | None = None
    """The cameras to use; None: all of a clip."""
    trusted: bool = False
    """Trust a calibration even where it seems wrong."""
    record: bool = False
    """Keep the viewers' reports for a replay."""
    resume: bool = False
    """Resume interrupted runs, and skip complete ones."""
    force: bool = False
    """Overwrite runs of other clips."""
    offset_s: float | None = None
    """Delay of camera 2."""
    background: str | None = None
    """"none": work without a model of the background."""
    people: Literal["1", "all"] | None = None
    """"all": follow everyone in view."""


def track_all(paths: Sequence[Path], out: Path, given: Asked, console: Console) -> Facts:
    """Track clip after clip and write a run folder for each.

    With several clips, an unusable one is reported and skipped.

    Args:
        paths: Clip folders and settings files; other plain files are reported and skipped.
        out: Gets a folder for each, named after the clip or the settings file.
        given: The user's options for all of them.
        console: Shows progress, warnings and errors.

    Raises:
        SettingsError, ClipError, DecoderDied, Undecodable, CannotResume: When the only clip cannot
            be used.
        ClipsFailed: When there is nothing to track, when two runs would have one folder, and at the
            end when any clip could not be used.
        RunError: When a run folder cannot be written.
    """
    runs = run_names(without_plain_files(paths, console))
    if given.record:
        refuse_without_library()
    done: Facts = {}
    with compiling_beside(), Decoders() as decoders, bar(console) as progress:
        for (name, path), tell in by_share(progress, [*runs.items()], "tracking"):
            try:
                own = config_file.load(path)
                refuse_no_source(own, path)
                named = given.mode, given.size, given.landmarks, given.offset_s, given.background
                settings = overridden(own, *named, given.people)
                if given.trusted:
                    settings = msgspec.structs.replace(settings, trust_calibration=True)
                told = {"the views": given.views, "what is recorded": given.record}
                wanted = Wanted(out / name, settings, told, given.resume)
                if not given.force:
                    refuse_other(wanted.folder, _run_of(settings))
                done[name] = done_before(wanted, console) or _tracked(
                    wanted, given, decoders, tell, console
                )
            except (SettingsError, ClipError, DecoderDied, Undecodable, *KEPT_AS_IT_IS) as error:
                if len(runs) == 1:
                    raise
                complain(console, str(error))
    if len(done) < len(runs):
        raise ClipsFailed(f"{len(runs) - len(done)} of {len(runs)} clips could not be tracked")
    return {"clips": done}


def _tracked(
    wanted: Wanted, given: Asked, decoders: Decoders, tell: Tell, console: Console
) -> Facts:
    """Track a clip and write its run; returns its summary."""
    folder, settings = wanted.folder, wanted.settings
    with resumable(wanted, console) as (work, made_of):
        heard = work.messages("heard") if given.record else None
        course, watch = Course(tell, work), None if heard is None else _recorder(heard)
        tracked = track_clip(settings, decoders, given.views, watch=watch, course=course)
        for warning in tracked.facts["warnings"]:
            warn(console, f"{folder.name}: {warning}")
        for word in clock_words(tracked.facts):
            say(console, f"{folder.name}: {word}")
        named = {"clip": folder.name, **belief_facts(tracked.bodies)}
        facts = {**tracked.facts, **named, **_run_of(settings).facts, **made_of}
        write_run(folder, tracked.bodies, settings, facts)
        if heard is not None:
            _write_recording(folder, tracked, settings, heard, console)
    return facts


def _run_of(settings: Settings) -> RunOf:
    return run_of("track", [view.source for view in sources_of(settings)])


def head_of(
    clip: Clip,
    settings: Settings,
    scale_source: ScaleSource | None = None,
    *,
    by_person: bool = False,
) -> Head:
    """The header of a clip's recording.

    Args:
        clip: With the rig that is known before the first frame.
        settings: The run's settings.
        scale_source: Source of that rig; None: it is calibrated, if there is one.
        by_person: The rig comes from the person during the run.
    """
    return Head(
        name=clip.name,
        settings=settings,
        period_s=clip.every / clip.views[0].fps,
        alone=len(clip.views) == 1,
        rig=whole_rig(clip),
        body=clip.body,
        cameras=camera_names(clip),
        times=frame_times(clip),
        scale_source=scale_source,
        by_person=by_person,
    )


def _recorder(heard: Kept) -> Watch:
    """Writes the messages of every instant, in the order in which a live run sends them."""

    def each(_frames: object, reports: dict[int, View], bodies: tuple[Body, ...]) -> None:
        for message in (*reports.values(), *bodies):
            heard.append(message)

    return Watch(each, heard.clear)


def _write_recording(
    folder: Path, tracked: Tracked, settings: Settings, heard: Kept, console: Console
) -> None:
    clip = tracked.clip
    if not heard:
        warn(
            console,
            f"{clip.name}: nothing was recorded: one camera without a calibration is followed in "
            "passes over the whole film; follow it again instead",
        )
        return
    measured = msgspec.structs.replace(clip, body=measured_before(settings))
    with recording_to(folder, head_of(measured, settings, tracked.facts["scale_source"])) as keep:
        for message in heard:
            keep(message)
