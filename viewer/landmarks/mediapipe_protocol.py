"""What the child that looks by MediaPipe answers: records of one length, sent in one piece."""

import struct
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.platform.platform import Broken

COUNT: Final = 33
"""Points of MediaPipe's body."""
NUMBERS: Final = 3
"""Column, row, visibility."""

READY: Final = b"r"
REFUSED: Final = b"x"
NOBODY: Final = b"n"
POINTS: Final = b"p"

_MAGIC: Final = b"tml1"
_HEAD: Final = struct.Struct("<4sci")
_BODY_BYTES: Final = 4 * COUNT * NUMBERS
BYTES: Final = _HEAD.size + _BODY_BYTES
"""Of every answer: less than a pipe takes at once, so that none is ever seen half written."""


class Answer(NamedTuple):
    """One answer of the child."""

    kind: bytes
    frame: int
    """-1 before the first."""
    points: NDArray[np.float32]
    """(33, 3) where the kind is POINTS."""
    text: str
    """Why it cannot work, where the kind is REFUSED."""


def encoded(
    kind: bytes, frame: int = -1, points: NDArray[np.float32] | None = None, text: str = ""
) -> bytes:
    """An answer as bytes."""
    body = text.encode() if points is None else points.tobytes()
    return _HEAD.pack(_MAGIC, kind, frame) + body[:_BODY_BYTES].ljust(_BODY_BYTES, b"\0")


def answer_of(answer: bytes) -> Answer:
    """Bytes as an answer.

    Raises:
        Broken: When no child of ours sends them.
    """
    magic, kind, frame = _HEAD.unpack_from(answer)
    body = answer[_HEAD.size :]
    points = np.frombuffer(body, "<f4").reshape(COUNT, NUMBERS)
    if magic != _MAGIC or kind not in (READY, REFUSED, NOBODY, POINTS):
        raise Broken("it sent what is no answer")
    if kind == POINTS and not np.isfinite(points).all():
        raise Broken("it sent points that are nowhere")
    text = body.rstrip(b"\0").decode(errors="replace") if kind == REFUSED else ""
    return Answer(kind, frame, points, text)
