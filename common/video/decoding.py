"""Frames of a video or camera, decoded by a child process that may crash in our place.

OpenCV aborts the whole process on some uncompressed AVIs. So none of our processes decodes: it asks
a child (common/video/decoder.py), which reads one source after another, reduces the pictures and
sends them through a pipe.
"""

import json
import struct
import threading
from collections.abc import Generator
from typing import Any, Final, Self

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.platform.platform import Broken, Child
from common.platform.platforms import platform
from common.video.pictures import (
    ALL,
    Decoded,
    DecoderDied,
    Ending,
    Image,
    Size,
    Source,
    Undecodable,
    VideoInfo,
    Wanted,
)

HEADER: Final = struct.Struct("<4scIdI")
"""Header of every answer: magic, kind, index, grabbed_s, number of bytes that follow."""
MAGIC: Final = b"ttf1"
INFO: Final = b"i"
TIMES: Final = b"t"
FRAME: Final = b"f"
SKIPPED: Final = b"s"
END: Final = b"e"
REFUSED: Final = b"r"

MAX_TEXT_BYTES: Final = 1 << 16
"""Upper bound of an answer other than a picture, bytes."""
TIMES_AT_ONCE: Final = 4096
"""Number of packet times in one answer: those of a long video take a while to read."""

DAMAGED: Final = struct.Struct("<I")
"""Payload of END: `Ending.damaged`."""

STALL_S: Final = 10.0
"""Seconds without an answer after which a child counts as stuck: opening a slow camera takes 3
s."""


class _Answer(msgspec.Struct, frozen=True):
    kind: bytes
    index: int
    grabbed_s: float
    payload: NDArray[np.uint8]


class Decoder:
    """Reads source after source through one child.

    The child starts with the first source. One that crashed, or was left in the middle of a source,
    is replaced at the next.
    """

    def __init__(self, stall_s: float = STALL_S) -> None:
        """No child yet; it will count as stuck after `stall_s` without an answer."""
        self.ending = Ending()
        """The ending of the last source that was read to its end."""
        self._stall_s = stall_s
        self._child: Child | None = None
        self._lock = threading.Lock()
        self._stopped = False

    def __enter__(self) -> Self:
        """Nothing to do before the first source."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the child."""
        self.close()

    @property
    def pid(self) -> int | None:
        """The child's process number; None while there is none."""
        child = self._child
        return child.pid if child else None

    def start(self, source: Source) -> None:
        """Start the child before a source is asked for: a new Python imports for seconds.

        Raises:
            DecoderDied: When this decoder was stopped.
        """
        self._ready(source)

    def probe(self, source: Source) -> VideoInfo:
        """The facts of a source; its first picture is decoded for them.

        Raises:
            Undecodable: When it has no picture.
            DecoderDied: When the child crashed on it.
        """
        info, *after = self._answers(source, [], ALL)
        told = msgspec.json.decode(info.payload.tobytes(), type=VideoInfo)
        shown = [np.frombuffer(one.payload, "<f8") for one in after if one.kind == TIMES]
        shown_s = tuple(np.concatenate(shown).tolist()) if shown else ()
        return msgspec.structs.replace(told, shown_s=shown_s)

    def frames(
        self, source: Source, size: Size, wanted: Wanted = ALL
    ) -> Generator[Decoded, None, None]:
        """The wanted pictures of a source, reduced to `size`.

        Frames before `wanted.start` are skipped, which is faster than decoding them.

        Raises:
            Undecodable: When it has no picture.
            DecoderDied: When the child crashed on it; the pictures before are valid.
        """
        sizes = [size] if wanted.large is None else [size, wanted.large]
        for answer in self._answers(source, sizes, wanted):
            if answer.kind == FRAME and answer.index >= wanted.start:
                pictures = _pictures(answer.payload, sizes)
                yield Decoded(answer.index, answer.grabbed_s, *pictures)
            elif answer.kind == END:
                (damaged,) = DAMAGED.unpack(answer.payload.tobytes())
                self.ending = Ending(answer.index, damaged)

    def stop(self) -> None:
        """Stop for good, from any thread; a thread that reads its frames then gets DecoderDied."""
        with self._lock:
            self._stopped = True
            if self._child is not None:
                self._child.kill()

    def close(self) -> None:
        """End the child and close its pipes; the next source gets a new child."""
        with self._lock:
            if self._child is not None:
                self._child.close()
            self._child = None

    def _answers(
        self, source: Source, sizes: list[Size], wanted: Wanted
    ) -> Generator[_Answer, None, None]:
        """INFO, then FRAMEs and SKIPPEDs if a size is asked for, else TIMES; then END."""
        child, frames, whole = self._ready(source), 0, False
        try:
            told = {"every": wanted.every, "start": wanted.start, "quarters": wanted.quarters}
            child.ask(json.dumps({"source": source, "sizes": sizes, **told}).encode())
            while not whole:
                answer = _next_answer(child, sizes)
                whole = answer.kind in (END, REFUSED)
                if answer.kind == REFUSED:
                    raise Undecodable(answer.payload.tobytes().decode())
                frames += answer.kind == FRAME
                yield answer
        except Broken as error:
            raise DecoderDied(source, frames, str(error)) from error
        finally:
            if not whole:
                self.close()

    def _ready(self, source: Source) -> Child:
        """The child, started where there is none."""
        with self._lock:
            if self._stopped:
                raise DecoderDied(source, 0, "it was stopped")
            if self._child is None:
                self._child = platform().child(f"{__package__}.decoder", self._stall_s)
            return self._child


def _pictures(payload: NDArray[np.uint8], sizes: list[Size]) -> list[Image]:
    """The pictures that follow each other in the payload of a FRAME."""
    ends = np.cumsum([3 * width * height for width, height in sizes])
    parts = np.split(payload, ends[:-1])
    return [part.reshape(h, w, 3) for part, (w, h) in zip(parts, sizes, strict=True)]


def _next_answer(child: Child, sizes: list[Size]) -> _Answer:
    head = bytearray(HEADER.size)
    child.read_into(memoryview(head))
    magic, kind, index, grabbed_s, length = HEADER.unpack(head)
    due = length == DAMAGED.size if kind == END else length <= MAX_TEXT_BYTES
    if kind == FRAME:
        due = bool(sizes) and length == sum(3 * width * height for width, height in sizes)
    if magic != MAGIC or not due:
        raise Broken("it sent what is no answer")
    payload: Any = np.empty(length, np.uint8)
    child.read_into(memoryview(payload))
    return _Answer(kind, index, grabbed_s, payload)
