"""The child that decodes: it answers one source a line."""

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
from common.video.pictures import Image, Source, cure, named
from common.video.reduction import reduced

SIGN_OF_LIFE: Final = 100
"""While frames are passed over, the asker hears every so many that the work goes on."""


PROGRESSIVE: Final = "make it progressive (ffmpeg -i IN -vf yadif -c:v mjpeg -q:v 2 OUT.avi)"
"""The cure of a video of fields."""


class Refused(ValueError):
    """A source of which no pictures can be made; the text names it and the cure."""


@dataclass(frozen=True, slots=True)
class Grabbed:
    """A frame of the source; without its picture where that was not asked for or is broken."""

    index: int
    grabbed_s: float
    picture: Image | None
    damaged: bool = False
    """The decoder met damage in it, or before it."""


class OpenFilm(NamedTuple):
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
    """Say what a source is, send its frames at each size given, else their times; then END.

    Raises:
        Refused: When no pictures can be made of it, also in its middle.
    """
    source, sizes = request["source"], request["sizes"]
    complaints.taken()  # of the source before
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
    damaged += bool(complaints.taken())  # a missing end is complained of after the last frame
    say(answers, END, Grabbed(came, time.monotonic(), None), DAMAGED.pack(damaged))


def say_times(source: Source, answers: Answers) -> None:
    """Send when each packet of a file is to be shown, seconds; none of a camera or a picture."""
    if not isinstance(source, str) or cv2.haveImageReader(source):
        return
    packets = cv2.VideoCapture(source, cv2.CAP_FFMPEG, [cv2.CAP_PROP_FORMAT, -1])
    going = True
    while going:
        some: list[float] = []
        while len(some) < TIMES_AT_ONCE and (going := packets.grab()):
            some.append(packets.get(cv2.CAP_PROP_POS_MSEC) / 1e3)
        say(answers, TIMES, None, np.array(some, "<f8").tobytes())
        answers.flush()


def opened(source: Source, every: int, start: int, complaints: Complaints) -> OpenFilm:
    """A video, a camera, or a still picture as a film of one frame.

    Args:
        source: Of the pictures.
        every: Only frames whose index is a multiple of it are decoded to pictures ...
        start: ... and only the very first one and those from this index on.
        complaints: What is said of it.
    """
    if isinstance(source, str) and cv2.haveImageReader(source) and cv2.imcount(source) == 1:
        return OpenFilm(0.0, 1, iter([Grabbed(0, time.monotonic(), cv2.imread(source))]))
    capture = cv2.VideoCapture(source)
    fps, frames = capture.get(cv2.CAP_PROP_FPS), capture.get(cv2.CAP_PROP_FRAME_COUNT)
    taken = grabs(capture, every, start)
    if isinstance(source, str):
        taken = judged(taken, source, complaints)
    return OpenFilm(max(0.0, fps), max(0, round(frames)), taken)


def judged(taken: Iterator[Grabbed], source: str, complaints: Complaints) -> Iterator[Grabbed]:
    """The frames of a file, and in which of them the decoder met damage.

    Complaints up to the first frame do not count as damage: a video that was trimmed may begin in
    the middle of a stream.

    Raises:
        Refused: When a frame is interlaced: OpenCV reports success but fills in no
            picture.
    """
    for grab in taken:
        said = complaints.taken()
        if INTERLACED in said:
            raise Refused(f"{source} is interlaced: {PROGRESSIVE}")
        yield replace(grab, damaged=grab.index > 0 and bool(said))


def grabs(capture: cv2.VideoCapture, every: int, start: int) -> Iterator[Grabbed]:
    """Every frame, decoded to a picture where that is wanted."""
    for index in itertools.count():
        if not capture.grab():
            return
        now_s = time.monotonic()
        is_wanted = index % every == 0 and (index >= start or index == 0)
        yield Grabbed(index, now_s, capture.retrieve()[1] if is_wanted else None)


def say(
    answers: Answers, kind: bytes, grab: Grabbed | None = None, *parts: bytes | memoryview
) -> None:
    """Send one answer; pictures at once, so that a live one does not wait."""
    index, grabbed_s = (grab.index, grab.grabbed_s) if grab else (0, 0.0)
    length = sum(memoryview(part).nbytes for part in parts)
    answers.write(HEADER.pack(MAGIC, kind, index, grabbed_s, length))
    for part in parts:
        answers.write(part)
    if kind == FRAME:
        answers.flush()
