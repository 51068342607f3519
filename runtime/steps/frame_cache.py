"""Decoded pictures of a source, kept for its next reading where they are small enough."""

import math
from collections.abc import Callable, Iterator
from typing import Final

from common.video.pictures import ALL, Decoded, Ending, Reader, Size, Source, Wanted

MOST_BYTES: Final = 1 << 27
"""Upper bound of the cache, bytes: 38 s at 320x240 and 15 Hz, 2.5 minutes at 160x120."""


class FrameCache:
    """Reads a clip through a decoder; a small clip that was read to its end is decoded once.

    A clip is read once to learn the background and again to track. A cache serves one clip: it does
    not notice that the file has changed.
    """

    def __init__(self, decoder: Reader, most_bytes: int = MOST_BYTES, due: int = 0) -> None:
        """Empty at first.

        Args:
            decoder: Reads the clip.
            most_bytes: Upper bound of the cache.
            due: Number of frames that the clip claims; if that is too many, no frame is kept.
        """
        self._decoder = decoder
        self._due = due
        self._most_bytes = most_bytes
        self._named: tuple[Source, Size, int] | None = None
        self._kept: list[Decoded] = []

    @property
    def ending(self) -> Ending:
        """The ending of the last source that was decoded to its end."""
        return self._decoder.ending

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        """The wanted pictures, reduced to `size`; those of a second size are not kept.

        Raises:
            Undecodable: When it has none.
            DecoderDied: When the decoder crashed on it.
        """
        asked = (source, size, wanted.quarters)
        if wanted.large is None and asked == self._named:
            due = (got for got in self._kept if got.index >= wanted.start)
            return (got for got in due if got.index % wanted.every == 0)
        pictures = self._decoder.frames(source, size, wanted)
        every_one = wanted == ALL._replace(quarters=wanted.quarters)
        return self._keeping(pictures, asked) if every_one else pictures

    def _keeping(
        self, pictures: Iterator[Decoded], asked: tuple[Source, Size, int]
    ) -> Iterator[Decoded]:
        """Yield all pictures, and keep them once they are known to be complete and to fit."""
        kept: list[Decoded] = []
        fits = self._most_bytes // (3 * math.prod(asked[1]))
        if self._due > fits:
            yield from pictures
            return
        came = 0
        for came, got in enumerate(pictures, 1):
            if came <= fits:
                kept.append(got)
            elif kept:
                kept = []
            yield got
        if came <= fits:
            self._named, self._kept = asked, kept


class Told:
    """Reads through another reader, and reports the share of the expected frames so far."""

    def __init__(self, reader: Reader, due: int, tell: Callable[[float], object]) -> None:
        """No report yet; beyond `due` frames there are no more reports."""
        self._reader, self._due, self._tell = reader, max(1, due), tell

    @property
    def ending(self) -> Ending:
        """The ending of the last source that was read to its end."""
        return self._reader.ending

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        """The wanted pictures of a source, reduced to `size`."""
        for got in self._reader.frames(source, size, wanted):
            self._tell(min(1.0, (got.index + 1) / self._due))
            yield got
