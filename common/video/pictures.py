"""Pictures of a video or a camera, how they are asked for, and why there are none."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple, Protocol

import msgspec
import numpy as np
from numpy.typing import NDArray

STILLS: Final = {".png", ".jpg", ".jpeg", ".bmp", ".webp", ".tif", ".tiff"}
"""How names of single pictures end."""

Image = NDArray[np.uint8]
"""(height, width, 3), blue, green, red."""

Source = str | int
"""A file, or the number of a camera of this host."""

Size = tuple[int, int]
"""Width and height, pixels."""


class Undecodable(ValueError):
    """A source without a single picture; the text names it and the cure."""


class DecoderDied(RuntimeError):
    """The child broke on a source: the text names it, how far it came, how it died, the cure."""

    def __init__(self, source: Source, frames: int, how: str) -> None:
        """After `frames` frames of `source`."""
        super().__init__(source, frames, how)
        self.source, self.frames, self.how = source, frames, how

    def __str__(self) -> str:
        """One line."""
        where = f"after {self.frames} frames ({self.how})"
        return f"{named(self.source)} broke the decoder {where}: {cure(self.source)}"


class CameraLost(DecoderDied):
    """A camera that gives no more pictures, as one that was unplugged: it has no end of its own."""

    def __init__(self, source: int, frames: int) -> None:
        """After `frames` frames of `source`."""
        super().__init__(source, frames, "no more pictures")

    def __str__(self) -> str:
        """One line."""
        gives = f"{named(self.source)} gives no more pictures after {self.frames}"
        return f"{gives}: {cure(self.source)}"


class VideoInfo(msgspec.Struct, frozen=True):
    """What a source says of itself; only the size was seen."""

    width: int
    height: int
    fps: float
    """0 where it names none."""
    frames: int
    """0 where it names none, as a camera."""
    shown_s: tuple[float, ...] = ()
    """When a file's pictures are to be shown, by its packets: in their order, not in time's."""


class Wanted(NamedTuple):
    """Which pictures of a source are asked for, and in which sizes besides the first."""

    every: int = 1
    """Every n-th."""
    start: int = 0
    """None before this place in the source."""
    large: Size | None = None
    """A second size of each."""
    quarters: int = 0
    """By how many quarter turns clockwise each is turned; sizes are of what that gives."""


ALL: Final = Wanted()


class Ending(NamedTuple):
    """How far a source could be read."""

    frames: int = 0
    """How many it really had."""
    damaged: int = 0
    """In how many of them, or behind them, the decoder met damage."""


class Decoded(msgspec.Struct, frozen=True):
    """One picture of a source."""

    index: int
    """Number of the frame in the source, also where only every n-th is taken."""
    grabbed_s: float
    """When it was grabbed, by this host's monotonic clock."""
    picture: Image
    large: Image | None = None
    """The frame's picture at the second size, where one was asked for."""


class Reader(Protocol):
    """Whatever gives the pictures of a source: a decoder, or a reel before it."""

    @property
    def ending(self) -> Ending:
        """Of the source that was last read to its end."""

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        """The wanted pictures of a source, reduced to `size`."""


def named(source: Source) -> str:
    """A source as a message names it."""
    return f"camera {source}" if isinstance(source, int) else source


def cure(source: Source) -> str:
    """What to do about a source that cannot be read."""
    if isinstance(source, int):
        return "see that it is plugged in and that no other program holds it"
    if Path(source).suffix.lower() in STILLS:
        return "save the picture anew, as PNG or JPEG"
    return (
        "convert it, for example to MJPEG (ffmpeg -i IN -c:v mjpeg -q:v 2 OUT.avi), or copy it "
        "again where it was cut off"
    )
