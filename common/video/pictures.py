"""Pictures of a video or camera: how they are requested, and the errors where there are none."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple, Protocol, TypeGuard

import msgspec
import numpy as np
from numpy.typing import NDArray

STILLS: Final = {".png", ".jpg", ".jpeg", ".bmp", ".webp", ".tif", ".tiff"}
"""Suffixes of single pictures."""

Image = NDArray[np.uint8]
"""(height, width, 3), blue, green, red."""

Source = str | int
"""A file, or the index of a camera of this host."""


def is_camera(source: Source) -> TypeGuard[int]:
    """Whether a source is a camera of this host: live, without an end."""
    return isinstance(source, int)


def is_recorded(source: Source) -> TypeGuard[str]:
    """Whether a source is a file: its frames are the same each time."""
    return isinstance(source, str)


Size = tuple[int, int]
"""Width and height, pixels."""


class Undecodable(ValueError):
    """A source without a single picture; the text names it and the cure."""


class DecoderDied(RuntimeError):
    """The child crashed on a source: the text names it, the frames read, the cause and the cure."""

    def __init__(self, source: Source, frames: int, how: str) -> None:
        """After `frames` frames of `source`."""
        super().__init__(source, frames, how)
        self.source, self.frames, self.how = source, frames, how

    def __str__(self) -> str:
        """One line."""
        where = f"after {self.frames} frames ({self.how})"
        return f"{named(self.source)} broke the decoder {where}: {cure(self.source)}"


class CameraLost(DecoderDied):
    """A camera that gives no more pictures, as when unplugged: a camera has no normal end."""

    def __init__(self, source: int, frames: int) -> None:
        """After `frames` frames of `source`."""
        super().__init__(source, frames, "no more pictures")

    def __str__(self) -> str:
        """One line."""
        gives = f"{named(self.source)} gives no more pictures after {self.frames}"
        return f"{gives}: {cure(self.source)}"


class VideoInfo(msgspec.Struct, frozen=True):
    """What a source reports of itself; only the size was verified."""

    width: int
    height: int
    fps: float
    """0 where it reports none."""
    frames: int
    """0 where it reports none, as for a camera."""
    shown_s: tuple[float, ...] = ()
    """Presentation times of a file's pictures, by its packets: in the order of pictures, not of
    time."""


class Wanted(NamedTuple):
    """Which pictures of a source are requested, and in which sizes besides the first."""

    every: int = 1
    """Stride: every n-th frame."""
    start: int = 0
    """No picture before this index."""
    large: Size | None = None
    """A second size of each picture."""
    quarters: int = 0
    """Clockwise quarter turns of each picture; sizes are after the turn."""


ALL: Final = Wanted()


class Ending(NamedTuple):
    """How far a source could be read."""

    frames: int = 0
    """The true number of frames."""
    damaged: int = 0
    """Number of frames in or after which the decoder met damage."""


class Decoded(msgspec.Struct, frozen=True):
    """One picture of a source."""

    index: int
    """Index of the frame in the source, also where only every n-th is used."""
    grabbed_s: float
    """Time of the grab, by this host's monotonic clock."""
    picture: Image
    large: Image | None = None
    """The picture at the second size, where one was requested."""


class Reader(Protocol):
    """A source of pictures: a decoder, or a cache before it."""

    @property
    def ending(self) -> Ending:
        """The ending of the last source that was read to its end."""

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        """The wanted pictures of a source, reduced to `size`."""


def named(source: Source) -> str:
    """The name of a source in messages."""
    return source if is_recorded(source) else f"camera {source}"


def cure(source: Source) -> str:
    """The cure for a source that cannot be read."""
    if not is_recorded(source):
        return "see that it is plugged in and that no other program holds it"
    if Path(source).suffix.lower() in STILLS:
        return "save the picture anew, as PNG or JPEG"
    return (
        "convert it, for example to MJPEG (ffmpeg -i IN -c:v mjpeg -q:v 2 OUT.avi), or copy it "
        "again where it was cut off"
    )
