"""Messages in a file, in the order in which they came: a sequence that takes no memory.

The records are those of the journal (`runtime/store/journal.py`).
"""

import os
import zlib
from array import array
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import IO, Any, Final, Generic, TypeVar, overload

import msgspec

from common.bus.message_codec import encode
from common.bus.messages import Message, View
from runtime.store.journal import FRAME, HEAD, KINDS, MAGIC, framed
from runtime.store.runs import unwritable

Kind = TypeVar("Kind", bound=Message)

MARKS: Final[dict[type[Message], bytes]] = {
    **{kind: mark for mark, kind in KINDS.items()},
    View: b"r",
}
_DECODERS: Final[dict[bytes, msgspec.msgpack.Decoder[Any]]] = {
    mark: msgspec.msgpack.Decoder(kind) for kind, mark in MARKS.items()
}
AT_ONCE: Final = 1 << 18
"""Bytes written, and read, at once."""


class Place(msgspec.Struct, frozen=True):
    """Extent of a file."""

    messages: int
    size: int
    """Bytes."""


class Torn(ValueError):
    """A damaged or shortened file."""


@contextmanager
def writing(folder: Path) -> Iterator[None]:
    """The error of a folder that cannot be written.

    Raises:
        RunError: In place of any OSError; the text says why.
    """
    try:
        yield
    except OSError as error:
        raise unwritable(folder, error) from error


class MessageFile(Sequence[Kind], Generic[Kind]):
    """Messages that are appended, and read any number of times."""

    def __init__(self, path: Path, head: bytes = b"", place: Place | None = None) -> None:
        """Begin a file, or continue one from a place: what follows it is removed.

        Args:
            path: A file in an existing folder.
            head: Payload of its first record; no record where it is empty.
            place: None: a new file.

        Raises:
            Torn: When the file is shorter, or damaged before that place.
            RunError: When it cannot be written; also raised when messages are appended or read.
        """
        self._path = path
        self._first = framed(HEAD, head) if head else b""
        self._starts = array("Q")
        if place is not None:
            self._size = self._scanned(place)
            with self._writing():
                self._file: IO[bytes] = path.open("r+b", AT_ONCE)
                self._file.truncate(self._size)
                self._file.seek(self._size)
            return
        with self._writing():
            self._file = path.open("wb", AT_ONCE)
            self._size = self._file.write(self._first)

    def append(self, message: Kind) -> None:
        """Append a message."""
        record = framed(MARKS[type(message)], encode(message))
        self._starts.append(self._size)
        with self._writing():
            self._file.write(record)
        self._size += len(record)

    def clear(self) -> None:
        """Remove all messages."""
        with self._writing():
            self._file.flush()
            self._file.truncate(len(self._first))
            self._file.seek(len(self._first))
        self._size = len(self._first)
        del self._starts[:]

    def synced(self) -> Place:
        """Its extent; up to there it survives a power cut."""
        with self._writing():
            self._file.flush()
            os.fsync(self._file.fileno())
        return Place(len(self), self._size)

    def close(self) -> None:
        """Append no more; it remains readable. Write errors were raised before."""
        with suppress(OSError):
            self._file.close()

    def __len__(self) -> int:
        """Number of messages."""
        return len(self._starts)

    def __iter__(self) -> Iterator[Kind]:
        """All of them, in order."""
        return self._read_from(0)

    @overload
    def __getitem__(self, index: int) -> Kind: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Kind]: ...
    def __getitem__(self, index: int | slice) -> Kind | Sequence[Kind]:
        """One of them, or several."""
        if isinstance(index, slice):
            return [self[n] for n in range(*index.indices(len(self)))]
        return next(self._read_from(range(len(self))[index]))

    def _read_from(self, first: int) -> Iterator[Kind]:
        if not self._file.closed:
            with self._writing():
                self._file.flush()
        left = len(self) - first
        with self._path.open("rb", AT_ONCE) as file:
            if left:
                file.seek(self._starts[first])
            for _ in range(left):
                _magic, mark, length, _sum = FRAME.unpack(file.read(FRAME.size))
                yield _DECODERS[mark].decode(file.read(length))

    def _writing(self) -> AbstractContextManager[None]:
        return writing(self._path.parent)

    def _scanned(self, place: Place) -> int:
        """Index the records before a place; its size."""
        size = 0
        try:
            with self._path.open("rb", AT_ONCE) as file:
                while size < place.size:
                    magic, mark, length, total = FRAME.unpack(file.read(FRAME.size))
                    known = magic == MAGIC and (mark == HEAD or mark in _DECODERS)
                    payload = file.read(length) if known and size + length <= place.size else b""
                    if len(payload) < length or not known or zlib.crc32(payload) != total:
                        break
                    if mark != HEAD:
                        _DECODERS[mark].decode(payload)  # the checksum is not over the magic
                        self._starts.append(size)
                    size += FRAME.size + length
        except Exception as error:
            raise Torn(f"{self._path} cannot be read: {error}") from error
        if size != place.size or len(self) != place.messages:
            raise Torn(f"{self._path} was damaged after {len(self)} messages")
        return size
