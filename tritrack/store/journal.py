"""`journal.bin`: what a live run measures, on disk as it goes, for when its process does not end.

Append-only: a head, then bodies, postures and rigs as they came, each with its length and sum. When
the run has written its results the journal goes; where it stands, its run was cut short, or still
goes on. It is not a recording (`recording.py`): that holds what viewers reported, is asked for, and
is whole when the run is over.
"""

import os
import struct
import time
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from common.bus.control_messages import Cameras
from common.bus.message_codec import MAX_BYTES, MalformedMessage, decode, encode
from common.bus.messages import PROTOCOL, Body, Message, Posture
from common.config.settings import Settings

NAME: Final = "journal.bin"
BEFORE: Final = "journal.before.bin"
"""The part before the newest; the one before that is given up."""
MOST_BYTES: Final = 1 << 27
"""Of each part: an hour and more at 15 frames a second, so as much as the results hold."""
SYNC_S: Final = 5.0
"""So often what was written is made to outlive a power cut; the process's own death it outlives
at once."""

FRAME: Final = struct.Struct("<4scII")
"""What goes before each record: magic, kind, bytes that follow, their CRC-32."""
MAGIC: Final = b"ttj1"
HEAD: Final = b"h"
KINDS: Final[dict[bytes, type[Message]]] = {b"b": Body, b"p": Posture, b"c": Cameras}
_MARKS: Final = {kind: mark for mark, kind in KINDS.items()}


class Head(msgspec.Struct, frozen=True, kw_only=True):
    """What the results of a run hold beside what was said."""

    settings: Settings
    facts: dict[str, Any]
    """Of the summary, as far as they are known at the start."""
    protocol: int = PROTOCOL


class Told(NamedTuple):
    """What a journal holds, each in the order in which it was said."""

    head: Head
    bodies: list[Body]
    postures: list[Posture]
    cameras: list[Cameras]


class Journal:
    """A journal that is being written; what the disk does not take is told, and the run goes on."""

    def __init__(self, folder: Path, head: Head, most_bytes: int = MOST_BYTES) -> None:
        """Begin one in a folder that is there; what is left there of an older run goes."""
        self.odd: list[str] = []
        """What could not be written, a line each time that it begins."""
        self._folder = folder
        self._head = framed(HEAD, msgspec.msgpack.encode(head))
        self._most_bytes = most_bytes
        self._file: int | None = None
        self._bytes = 0
        self._failing = False
        self._sync_s = time.monotonic() + SYNC_S
        remove(folder)
        self.keep(())

    def keep(self, messages: Iterable[Message]) -> None:
        """Write these too, whole or not at all; they are the system's when this returns."""
        new = b"".join(framed(_MARKS[type(one)], encode(one)) for one in messages)
        try:
            self._write(new)
            self._failing = False
        except OSError as error:
            if not self._failing:
                self.odd.append(
                    f"the journal cannot be written ({error.strerror}): until it can, what is "
                    "measured is kept in memory alone; free some space"
                )
            self._failing = True

    def close(self) -> None:
        """Write no more; the journal stays."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def remove(self) -> None:
        """The results are written: it is not needed any more."""
        self.close()
        remove(self._folder)

    def _write(self, new: bytes) -> None:
        if self._file is not None and self._bytes + len(new) > self._most_bytes:
            self.close()
            (self._folder / NAME).replace(self._folder / BEFORE)
        if self._file is None:
            self._file = os.open(self._folder / NAME, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o644)
            self._bytes = 0
        if self._bytes == 0:
            new = self._head + new
        self._append(new)
        if time.monotonic() > self._sync_s:
            os.fsync(self._file)
            self._sync_s = time.monotonic() + SYNC_S

    def _append(self, new: bytes) -> None:
        """All of it; of a part that a full disk took nothing is left."""
        assert self._file is not None
        done = 0
        try:
            while done < len(new):
                done += os.pwrite(self._file, new[done:], self._bytes + done)
        except OSError:
            os.ftruncate(self._file, self._bytes)
            raise
        self._bytes += done


def read_journal(folder: Path) -> Told | None:
    """What a run folder's journal holds; None where there is none, or no body in it.

    A record that was torn, and what stands behind it, is not there.
    """
    head: Head | None = None
    found: dict[type[Message], list[Any]] = {kind: [] for kind in KINDS.values()}
    for name in (BEFORE, NAME):
        path = folder / name
        for mark, payload in _records(path.read_bytes()) if path.is_file() else ():
            try:
                if mark == HEAD:
                    head = msgspec.msgpack.decode(payload, type=Head)
                else:
                    found[KINDS[mark]].append(decode(payload, KINDS[mark]))
            except (msgspec.DecodeError, MalformedMessage):  # of another version
                return None
    if head is None or not found[Body]:
        return None
    return Told(head, found[Body], found[Posture], found[Cameras])


def has_journal(folder: Path) -> bool:
    """Whether a folder is that of a run that was cut short, or goes on."""
    return (folder / NAME).is_file()


def remove(folder: Path) -> None:
    """Take a folder's journal away, if there is one."""
    for name in (BEFORE, NAME):
        (folder / name).unlink(missing_ok=True)


def put_aside(folder: Path, aside: Path) -> bool:
    """Move a folder's journal, if it holds a body, into a folder of its own, which is made.

    Raises:
        OSError: When it cannot be moved.
    """
    if not has_journal(folder) or read_journal(folder) is None:
        return False
    aside.mkdir(parents=True, exist_ok=True)
    for name in (BEFORE, NAME):
        if (folder / name).is_file():
            (folder / name).replace(aside / name)
    return True


def framed(mark: bytes, payload: bytes) -> bytes:
    """A record: what goes before it, then what it holds."""
    return FRAME.pack(MAGIC, mark, len(payload), zlib.crc32(payload)) + payload


def _records(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Kind and payload of each record, up to the first that is not whole."""
    at = 0
    while at + FRAME.size <= len(data):
        magic, mark, length, total = FRAME.unpack_from(data, at)
        payload = data[at + FRAME.size : at + FRAME.size + length]
        known = magic == MAGIC and (mark == HEAD or mark in KINDS) and length <= MAX_BYTES
        if not known or len(payload) < length or zlib.crc32(payload) != total:
            return
        yield mark, payload
        at += FRAME.size + length
