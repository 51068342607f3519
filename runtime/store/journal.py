"""`journal.bin`: a live run's measurements, written as they come, in case its process dies.

Append-only: a header, then bodies, postures and rigs as they came, each with its length and
checksum. Once the run has written its results the journal is removed; a journal that exists means
that its run was cut short, or is in progress. It is not a recording (`recording.py`): that holds
the viewers' reports, is optional, and is complete when the run is over.
"""

import os
import shutil
import struct
import time
import zlib
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from common.bus.control_messages import Cameras
from common.bus.message_codec import encode
from common.bus.messages import PROTOCOL, Body, Message, Posture
from common.config.settings import Settings
from common.npz_file import Facts

NAME: Final = "journal.bin"
NEW: Final = os.O_RDWR | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0)
"""How the file is opened: its bytes are left as they are, where a system changes ends of lines."""
BEFORE: Final = "journal.{:06d}.bin"
"""Names of the parts before the newest."""
MOST_BYTES: Final = 1 << 27
"""Largest size of each part, bytes."""
MOST_BODIES: Final = 54_000
"""Largest number of bodies in each part: an hour at 15 Hz."""
MOST_PARTS: Final = 12
"""Number of older parts: half a day at 15 Hz; beyond, the oldest is removed."""
ROW_BYTES: Final = 2_000
"""Bytes of a body in `poses.npz`: 1,812 in this version. While that is written the data exist
twice there, beside the journal."""
SYNC_S: Final = 5.0
"""Seconds between two syncs to disk, which survive a power cut; a crash of the process loses
nothing anyway."""

FRAME: Final = struct.Struct("<4scII")
"""Header of each record: magic, kind, length, CRC-32."""
MAGIC: Final = b"ttj1"
HEAD: Final = b"h"
KINDS: Final[dict[bytes, type[Message]]] = {b"b": Body, b"p": Posture, b"c": Cameras}
_MARKS: Final = {kind: mark for mark, kind in KINDS.items()}


class Head(msgspec.Struct, frozen=True, kw_only=True):
    """Facts for a run's results beside the messages."""

    settings: Settings
    facts: Facts
    """The summary's facts that are known at the start."""
    protocol: int = PROTOCOL


class _Part(NamedTuple):
    path: Path
    bodies: int


class Journal:
    """A journal that is being written; disk errors are reported, and the run goes on."""

    def __init__(
        self,
        folder: Path,
        head: Head,
        most_bytes: int = MOST_BYTES,
        most_parts: int = MOST_PARTS,
    ) -> None:
        """Begin one in an existing folder; an older run's journal is removed."""
        self.odd: list[str] = []
        """Lines about records that could not be written or were removed, one each time that it
        begins."""
        self.let_go = 0
        """Number of the oldest bodies that were removed."""
        self._folder = folder
        self._head = framed(HEAD, msgspec.msgpack.encode(head))
        self._most_bytes = most_bytes
        self._file: int | None = None
        self._bytes = self._bodies = self._turned = 0
        self._most_parts = most_parts
        self._older: deque[_Part] = deque()
        self._failing = False
        self._sync_s = time.monotonic() + SYNC_S
        remove(folder)
        self.keep(())

    def keep(self, messages: Sequence[Message]) -> None:
        """Append records, all or none; when this returns the system has them."""
        new = b"".join(framed(_MARKS[type(one)], encode(one)) for one in messages)
        try:
            self._write(new, sum(isinstance(one, Body) for one in messages))
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
        """Remove it: the results are written."""
        self.close()
        remove(self._folder)

    def _write(self, new: bytes, bodies: int) -> None:
        full = self._bytes + len(new) > self._most_bytes or self._bodies + bodies > MOST_BODIES
        if self._file is not None and full:
            self._turn()
        if self._file is None:
            self._file = os.open(self._folder / NAME, NEW, 0o644)
            self._bytes = self._bodies = 0
        if self._bytes == 0:
            new = self._head + new
        self._append(new)
        self._bodies += bodies
        if time.monotonic() > self._sync_s:
            os.fsync(self._file)
            self._sync_s = time.monotonic() + SYNC_S

    def _turn(self) -> None:
        """Begin a new part; the oldest are removed where they are too many, or where the results
        of all would not fit on the disk."""
        path = self._folder / BEFORE.format(self._turned)
        (self._folder / NAME).replace(path)
        self.close()
        self._turned += 1
        self._older.append(_Part(path, self._bodies))
        while len(self._older) > 1 and (len(self._older) > self._most_parts or self._is_scarce()):
            oldest = self._older.popleft()
            oldest.path.unlink(missing_ok=True)
            if not self.let_go:
                self.odd.append("a long run: of its beginning, what no longer finds room is let go")
            self.let_go += oldest.bodies

    def _is_scarce(self) -> bool:
        rows = sum(part.bodies for part in self._older) + MOST_BODIES
        return shutil.disk_usage(self._folder).free < 2 * ROW_BYTES * rows

    def _append(self, new: bytes) -> None:
        """Write everything; on a full disk the incomplete part is removed."""
        assert self._file is not None
        done = 0
        try:
            while done < len(new):
                os.lseek(self._file, self._bytes + done, os.SEEK_SET)
                done += os.write(self._file, new[done:])
        except OSError:
            os.ftruncate(self._file, self._bytes)
            raise
        self._bytes += done


def has_journal(folder: Path) -> bool:
    """Whether a folder belongs to a run that was cut short, or is in progress."""
    return (folder / NAME).is_file()


def parts_of(folder: Path) -> list[Path]:
    """The files of a folder's journal, oldest first."""
    newest = folder / NAME
    before = sorted(folder.glob(BEFORE.replace("{:06d}", "[0-9]" * 6)))
    return [*before, *([newest] if newest.is_file() else [])]


def remove(folder: Path) -> None:
    """Remove a folder's journal, if any."""
    for path in parts_of(folder):
        path.unlink(missing_ok=True)


def framed(mark: bytes, payload: bytes) -> bytes:
    """A record: its header and its payload."""
    return FRAME.pack(MAGIC, mark, len(payload), zlib.crc32(payload)) + payload
