"""The decoding child process: it answers one source per line."""

import itertools
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import cv2
import numpy as np

from common.platform.platform import Answers, Asker
from common.video.complaints import INTERLACED, Complaints
from common.video.decoding import (
    DAMAGED,
    END,
    FRAME,
    HEADER,
    INFO,
    MAGIC,
    REFUSED,
    SKIPPED,
    TIMES,
    TIMES_AT_ONCE,
)
from common.video.pictures import Image, Source, cure, is_recorded, named
from common.video.reduction import reduced

SIGN_OF_LIFE: Final = 100
"""While frames are skipped, the child reports progress every so many frames."""


TEXT_ART: Final = cv2.VideoWriter.fourcc(*"ansi")
"""Codec that FFmpeg has for texts."""
PROGRESSIVE: Final = "make it progressive (ffmpeg -i IN -vf yadif -c:v mjpeg -q:v 2 OUT.avi)"
"""The cure for an interlaced video."""


class Refused(ValueError):
    """A source that cannot be decoded; the text names it and the cure."""


@dataclass(frozen=True, slots=True)
class Grabbed:
    """A frame of the source; without a picture where none was asked for or it is broken."""

    index: int
    grabbed_s: float
    picture: Image | None
    damaged: bool = False
    """The decoder met damage in this frame, or before it."""


class OpenVideo(NamedTuple):
    """An open source."""

    fps: float
    frames: int
    grabs: Iterator[Grabbed]


def main(asker: Asker) -> None:
    """Answer until the asker is gone."""
    cv2.setNumThreads(1)
    answers, complaints = asker.answers, Complaints()
    for line in asker.requests:
        try:
            serve(json.loads(line), answers, complaints)
        except Refused as refusal:
            say(answers, REFUSED, None, str(refusal).encode())
        answers.flush()


def serve(request: dict[str, Any], answers: Answers, complaints: Complaints) -> None:
    """Send what a source is, its frames at each size asked for, or else their times; then END.

    Raises:
        Refused: When it cannot be decoded, even in its middle.
    """
    source, sizes = request["source"], request["sizes"]
    complaints.taken()  # left over from the source before
    film = opened(source, request["every"], request["start"], complaints)
    first = next((grab for grab in film.grabs if grab.picture is not None), None)
    if first is None or first.picture is None:
        raise Refused(f"{named(source)} gives no picture: {cure(source)}")
    height, width = first.picture.shape[:2]
    info = {"width": width, "height": height, "fps": film.fps, "frames": film.frames}
    say(answers, INFO, None, json.dumps(info).encode())
    if not sizes:
        say_times(source, answers)
    came, damaged = first.index + 1, 0
    for grab in itertools.chain([first], film.grabs) if sizes else ():
        came, damaged = grab.index + 1, damaged + grab.damaged
        if grab.picture is not None:
            pictures = [reduced(grab.picture, size, request["quarters"]) for size in sizes]
            say(answers, FRAME, grab, *(picture.data for picture in pictures))
        elif grab.index % SIGN_OF_LIFE == 0:
            say(answers, SKIPPED, grab)
            answers.flush()
    damaged += bool(complaints.taken())  # FFmpeg reports a missing end after the last frame
    say(answers, END, Grabbed(came, time.monotonic(), None), DAMAGED.pack(damaged))


def say_times(source: Source, answers: Answers) -> None:
    """Send the presentation time of each packet of a file, seconds; none for a camera or a
    picture."""
    if not is_recorded(source) or cv2.haveImageReader(source):
        return
    packets = cv2.VideoCapture(source, cv2.CAP_FFMPEG, [cv2.CAP_PROP_FORMAT, -1])
    going = True
    while going:
        some: list[float] = []
        while len(some) < TIMES_AT_ONCE and (going := packets.grab()):
            some.append(packets.get(cv2.CAP_PROP_POS_MSEC) / 1e3)
        say(answers, TIMES, None, np.array(some, "<f8").tobytes())
        answers.flush()


def opened(source: Source, every: int, start: int, complaints: Complaints) -> OpenVideo:
    """A video, a camera, or a still picture as a video of one frame.

    Args:
        source: The file or camera.
        every: Only frames whose index is a multiple of it are decoded to pictures, ...
        start: ... and only the very first one and those from this index on.
        complaints: FFmpeg's messages about it.

    Raises:
        Refused: When it is a text, of which FFmpeg makes a video of a terminal.
    """
    if is_recorded(source) and cv2.haveImageReader(source) and cv2.imcount(source) == 1:
        return OpenVideo(0.0, 1, iter([Grabbed(0, time.monotonic(), cv2.imread(source))]))
    capture = cv2.VideoCapture(source)
    if is_recorded(source) and round(capture.get(cv2.CAP_PROP_FOURCC)) == TEXT_ART:
        raise Refused(f"{source} is text, no video: name a video")
    fps, frames = capture.get(cv2.CAP_PROP_FPS), capture.get(cv2.CAP_PROP_FRAME_COUNT)
    taken = grabs(capture, every, start)
    if is_recorded(source):
        taken = judged(taken, source, complaints)
    return OpenVideo(max(0.0, fps), max(0, round(frames)), taken)


def judged(taken: Iterator[Grabbed], source: str, complaints: Complaints) -> Iterator[Grabbed]:
    """The frames of a file, each with whether the decoder met damage.

    Messages up to the first frame do not count as damage: a trimmed video may begin in the middle
    of a stream.

    Raises:
        Refused: When a frame is interlaced: OpenCV reports success but leaves the picture empty.
    """
    for grab in taken:
        said = complaints.taken()
        if INTERLACED in said:
            raise Refused(f"{source} is interlaced: {PROGRESSIVE}")
        yield replace(grab, damaged=grab.index > 0 and bool(said))


def grabs(capture: cv2.VideoCapture, every: int, start: int) -> Iterator[Grabbed]:
    """Every frame, decoded to a picture where wanted."""
    for index in itertools.count():
        if not capture.grab():
            return
        now_s = time.monotonic()
        is_wanted = index % every == 0 and (index >= start or index == 0)
        yield Grabbed(index, now_s, capture.retrieve()[1] if is_wanted else None)


def say(
    answers: Answers, kind: bytes, grab: Grabbed | None = None, *parts: bytes | memoryview
) -> None:
    """Send one answer; pictures immediately, so that a live one does not wait."""
    index, grabbed_s = (grab.index, grab.grabbed_s) if grab else (0, 0.0)
    length = sum(memoryview(part).nbytes for part in parts)
    answers.write(HEADER.pack(MAGIC, kind, index, grabbed_s, length))
    for part in parts:
        answers.write(part)
    if kind == FRAME:
        answers.flush()
