"""What the dropped files are, one by one and together, in words."""

import filecmp
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Final, NamedTuple

from animator.start.sections import ShownFile, Tray
from common.bus.messages import MOST_VIEWS
from common.sound.sound_of_video import RATE_HZ, sound_of
from common.sound.sound_offset import delay_of
from common.video.clip_sources import ClipError
from common.video.clips import probed, refuse_no_video
from common.video.decoding import Decoder
from common.video.pictures import DecoderDied, VideoInfo
from runtime.sound_clocks import MOST_S
from tritrack.starting.job_plan import name_of_files, tasks_of
from tritrack.starting.uploads import Upload

SAME_RATE: Final = 0.01
"""Largest relative difference of rates that count as one."""
SAME_S: Final = 0.5
"""Largest difference of lengths that is not told, seconds."""


BLOCKED: Final = "Take away what is marked, or mend it and drop it again."


class Facts(NamedTuple):
    """What was found out about a whole file."""

    info: VideoInfo | None = None
    fault: str = ""
    twin: int | None = None
    """Number of a file of the same content."""


def facts_of(upload: Upload, decoder: Decoder, others: Sequence[Upload] = ()) -> Facts:
    """The facts of a video; those of a calibration are its command's to find.

    Args:
        upload: The file.
        decoder: Reads it.
        others: The other whole files: none may be the same.
    """
    if upload.is_calibration:
        return Facts()
    try:
        twin = next((one for one in others if is_same(one, upload)), None)
        if twin is not None:
            return Facts(fault=f"the same file as {twin.title}: take one away", twin=twin.number)
        info = probed(str(upload.path), decoder)
        refuse_no_video(str(upload.path), info.frames, info.fps)
    except (ClipError, DecoderDied, OSError) as error:
        said = str(error).replace(str(upload.path), upload.title)
        return Facts(fault=f"{said}. Take it away if it is no video.")
    return Facts(info)


def is_same(one: Upload, other: Upload) -> bool:
    """Whether two files have the same content.

    Raises:
        OSError: When one cannot be read.
    """
    return one.bytes == other.bytes and filecmp.cmp(one.path, other.path, shallow=False)


def late_by_sound(first: Path, other: Path) -> float | None:
    """How late a video is after the first by both sounds, seconds; None where they do not tell."""
    one = sound_of(first)
    own = None if one is None else sound_of(other)
    if one is None or own is None:
        return None
    told = delay_of(one, own, RATE_HZ, MOST_S)
    return round(told.late_s, 3) if told.is_clear else None


def length_s(info: VideoInfo) -> float:
    """Length of a video, seconds; 0 where it does not tell."""
    return info.frames / info.fps if info.fps > 0 else 0.0


def words_of(info: VideoInfo) -> str:
    """Length, rate, size and shape."""
    shape = "upright" if info.height > info.width else "wide"
    rate = f"{info.frames} frames at {info.fps:.4g} a second" if info.fps else "no frame rate"
    return f"{length_s(info):.1f} s, {rate}, {info.width}x{info.height}, {shape}"


def together(names: Sequence[str], infos: Sequence[VideoInfo]) -> str:
    """What several videos are together, and what differs between them."""
    if not infos:
        return ""
    if len(infos) == 1:
        return "One video: a person is followed with one camera."
    if len(infos) > MOST_VIEWS:
        return f"{len(infos)} videos: {MOST_VIEWS} at most make a clip."
    said = [
        f"{len(infos)} videos of one scene, by {len(infos)} cameras: {names[0]} is camera 1, "
        "which should see the person's front."
    ]
    pairs = [*pairwise(infos)]
    if any(abs(one.fps - other.fps) > SAME_RATE * max(one.fps, other.fps) for one, other in pairs):
        said.append("Their rates differ: they are brought together by time.")
    if any(abs(length_s(one) - length_s(other)) > SAME_S for one, other in pairs):
        said.append("Their lengths differ: they were started or ended at different times.")
    said.append("How late one is after the other is found from sound or motion, unless you say it.")
    return " ".join(said)


def shown_tray(
    files: Sequence[Upload],
    facts: Mapping[int, Facts],
    late_s: Mapping[tuple[int, int], float | None] = MappingProxyType({}),
) -> Tray:
    """In the form for browsers.

    Args:
        files: In the order of the cameras.
        facts: Of those that came whole, by their numbers.
        late_s: How late the second of two numbers is after the first, where their sounds tell.
    """
    ready = [one for one in files if one.number in facts and not facts[one.number].fault]
    infos = [info for one in ready if (info := facts[one.number].info) is not None]
    calibrations = sum(one.is_calibration for one in ready)
    whole = len(ready) == len(files)
    said = together([one.title for one in ready if not one.is_calibration], infos)
    if calibrations:
        said = "A calibration of another program."
        said += "" if len(files) == 1 else " Take it over by itself: take the other files away."
    return Tray(
        files=[
            _shown(one, facts.get(one.number), late_s.get((files[0].number, one.number)))
            for one in files
        ],
        tasks=tasks_of(len(infos), calibrations) if whole else (),
        says=said if whole else BLOCKED if any(one.fault for one in facts.values()) else "",
        name=name_of_files([one.path.stem for one in files]) if files else "",
    )


def _shown(upload: Upload, facts: Facts | None, late_s: float | None) -> ShownFile:
    info = None if facts is None else facts.info
    late = "" if late_s is None else f", {late_s:+.2f} s late by its sound"
    return ShownFile(
        file=upload.number,
        name=upload.title,
        bytes=upload.bytes,
        got=upload.got,
        facts="" if info is None else words_of(info) + late,
        fault="" if facts is None else facts.fault,
        kind="calibration" if upload.is_calibration else "video",
    )
