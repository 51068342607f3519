"""The child that decodes: `python -m common.video.decoder PIPE` answers one source a line."""

import itertools
import json
import os
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import IO, Any, Final, NamedTuple

import cv2
import numpy as np

from common.parent_death import end_with_pipe
from common.video.decoding import (
    END,
    FRAME,
    HEADER,
    INFO,
    MAGIC,
    REFUSED,
    SKIPPED,
    TIMES,
    TIMES_AT_ONCE,
    Image,
    Source,
    cure,
    named,
)

SIGN_OF_LIFE: Final = 100
"""Of so many frames that are passed over the asker hears: grabbing many takes a while."""


@dataclass(frozen=True, slots=True)
class Grabbed:
    """A frame of the source; without its picture where that was not asked for or is broken."""

    index: int
    grabbed_s: float
    picture: Image | None


class OpenFilm(NamedTuple):
    """An open source."""

    fps: float
    frames: int
    grabs: Iterator[Grabbed]


def main() -> None:
    """Answer until the asker is gone."""
    end_with_pipe(sys.stdin.fileno())
    cv2.setNumThreads(1)
    answers = os.fdopen(int(sys.argv[1]), "wb")
    for line in sys.stdin:
        serve(json.loads(line), answers)
        answers.flush()


def serve(request: dict[str, Any], answers: IO[bytes]) -> None:
    """Say what a source is, send its frames at each size given, else their times; then END."""
    source, sizes = request["source"], request["sizes"]
    film = opened(source, request["every"], request["start"])
    first = next((grab for grab in film.grabs if grab.picture is not None), None)
    if first is None or first.picture is None:
        refusal = f"{named(source)} gives no picture: {cure(source)}"
        say(answers, REFUSED, None, refusal.encode())
        return
    height, width = first.picture.shape[:2]
    info = {"width": width, "height": height, "fps": film.fps, "frames": film.frames}
    say(answers, INFO, None, json.dumps(info).encode())
    if not sizes:
        say_times(source, answers)
    came = first.index + 1
    for grab in itertools.chain([first], film.grabs) if sizes else ():
        came = grab.index + 1
        if grab.picture is not None:
            pictures = [reduced(grab.picture, size, request["quarters"]) for size in sizes]
            say(answers, FRAME, grab, *(picture.data for picture in pictures))
        elif grab.index % SIGN_OF_LIFE == 0:
            say(answers, SKIPPED, grab)
            answers.flush()
    say(answers, END, Grabbed(came, time.monotonic(), None))


def say_times(source: Source, answers: IO[bytes]) -> None:
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


def opened(source: Source, every: int, start: int) -> OpenFilm:
    """A video, a camera, or a still picture as a film of one frame.

    Args:
        source: Of the pictures.
        every: Only frames whose index is a multiple of it are decoded to pictures ...
        start: ... and only the very first one and those from this index on.
    """
    if isinstance(source, str) and cv2.haveImageReader(source) and cv2.imcount(source) == 1:
        return OpenFilm(0.0, 1, iter([Grabbed(0, time.monotonic(), cv2.imread(source))]))
    capture = cv2.VideoCapture(source)
    fps, frames = capture.get(cv2.CAP_PROP_FPS), capture.get(cv2.CAP_PROP_FRAME_COUNT)
    return OpenFilm(max(0.0, fps), max(0, round(frames)), grabs(capture, every, start))


def grabs(capture: cv2.VideoCapture, every: int, start: int) -> Iterator[Grabbed]:
    """Every frame, decoded to a picture where that is wanted."""
    for index in itertools.count():
        if not capture.grab():
            return
        now_s = time.monotonic()
        is_wanted = index % every == 0 and (index >= start or index == 0)
        yield Grabbed(index, now_s, capture.retrieve()[1] if is_wanted else None)


def reduced(picture: Image, size: Sequence[int], quarters: int) -> Image:
    """A picture turned clockwise by quarter turns, and then of another size (width, height).

    Each pixel is the mean of what it covers (P1).
    """
    width, height = size
    lying = (height, width) if quarters % 2 else (width, height)
    if (picture.shape[1], picture.shape[0]) != lying:
        picture = cv2.resize(picture, lying, interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(np.rot90(picture, -quarters)) if quarters else picture


def say(
    answers: IO[bytes], kind: bytes, grab: Grabbed | None = None, *parts: bytes | memoryview
) -> None:
    """Send one answer; pictures at once, so that a live one does not wait."""
    index, grabbed_s = (grab.index, grab.grabbed_s) if grab else (0, 0.0)
    length = sum(memoryview(part).nbytes for part in parts)
    answers.write(HEADER.pack(MAGIC, kind, index, grabbed_s, length))
    for part in parts:
        answers.write(part)
    if kind == FRAME:
        answers.flush()


if __name__ == "__main__":
    main()
