"""What a live run said, kept for what is written at its end: the newest, in a file."""

import os
import tempfile
import weakref
from array import array
from collections.abc import Callable, Iterable, Iterator
from itertools import islice, takewhile
from pathlib import Path
from typing import Final, Generic

from common.bus.message_codec import Said, decode, encode

MOST_KEPT: Final = 54_000
"""An hour at 15 frames a second. A body takes 3 kB so; as many again may lie in the files."""


class MessageLog(Generic[Said]):
    """The newest messages of one kind; the oldest give way, counted."""

    def __init__(self, kind: type[Said], most: int = MOST_KEPT, folder: Path | None = None) -> None:
        """None yet; at most so many, in files without a name of that folder's disk."""
        self.let_go = 0
        """How many gave way."""
        self._kind, self._most, self._folder = kind, most, folder
        self._older, self._newer = _Shelf(folder), _Shelf(folder)

    def add(self, messages: Iterable[Said]) -> None:
        """Keep these too."""
        for message in messages:
            if len(self._newer) == self._most:  # all that is kept: the older shelf's time is over
                self._older, self._newer = self._newer, _Shelf(self._folder)
            self.let_go += len(self._older) + len(self._newer) >= self._most
            self._newer.append(encode(message))

    def all(self) -> list[Said]:
        """What is kept, oldest first."""
        return list(self._from_newest(self._most))[::-1]

    def newest(self, wanted: Callable[[Said], bool], most: int = MOST_KEPT) -> list[Said]:
        """The newest ones that are wanted, oldest first, up to the first that is not."""
        return list(takewhile(wanted, self._from_newest(min(most, self._most))))[::-1]

    def _from_newest(self, most: int) -> Iterator[Said]:
        shelves = (self._newer, self._older)
        packed = (shelf[n] for shelf in shelves for n in reversed(range(len(shelf))))
        return (decode(each, self._kind) for each in islice(packed, most))


class _Shelf:
    """Packed messages in their order: in a file, and in memory from where the disk takes none."""

    def __init__(self, folder: Path | None) -> None:
        """Empty; the file is made for the first."""
        self._folder = folder
        self._file: int | None = None
        self._ends = array("Q", [0])
        self._left: list[bytes] = []

    def __len__(self) -> int:
        return len(self._ends) - 1 + len(self._left)

    def __getitem__(self, index: int) -> bytes:
        """One of them.

        Raises:
            OSError: When the disk does not give it back.
        """
        filed = len(self._ends) - 1
        if index >= filed:
            return self._left[index - filed]
        assert self._file is not None
        start = self._ends[index]
        return os.pread(self._file, self._ends[index + 1] - start, start)

    def append(self, packed: bytes) -> None:
        """One more."""
        if self._left or not self._is_filed(packed):
            self._left.append(packed)
        else:
            self._ends.append(self._ends[-1] + len(packed))

    def _is_filed(self, packed: bytes) -> bool:
        try:
            if self._file is None:
                with tempfile.TemporaryFile(dir=self._folder) as file:
                    self._file = os.dup(file.fileno())
                weakref.finalize(self, os.close, self._file)
            return os.pwrite(self._file, packed, self._ends[-1]) == len(packed)
        except OSError:
            return False
