"""`journal.bin`: what a live run measures, on disk as it goes, for when its process does not end.

Append-only: a head, then bodies, postures and rigs as they came, each with its length and sum. When
the run has written its results the journal goes; where it stands, its run was cut short, or still
goes on. It is not a recording (`recording.py`): that holds what viewers reported, is asked for, and
is whole when the run is over.
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
BEFORE: Final = "journal.{:06d}.bin"
"""The parts before the newest."""
MOST_BYTES: Final = 1 << 27
"""Of each part."""
MOST_BODIES: Final = 54_000
"""Of each part: an hour at 15 frames a second."""
MOST_PARTS: Final = 12
"""Before the newest: half a day at 15 frames a second; the oldest is given up then."""
ROW_BYTES: Final = 2_000
"""Of a body in `poses.npz`: 1,812, as of this version. While that is written it stands there twice,
beside the journal."""
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
    facts: Facts
    """Of the summary, as far as they are known at the start."""
    protocol: int = PROTOCOL


class _Part(NamedTuple):
    path: Path
    bodies: int


class Journal:
    """A journal that is being written; what the disk does not take is told, and the run goes on."""

    def __init__(
        self,
        folder: Path,
        head: Head,
        most_bytes: int = MOST_BYTES,
        most_parts: int = MOST_PARTS,
    ) -> None:
        """Begin one in a folder that is there; what is left there of an older run goes."""
        self.odd: list[str] = []
        """What could not be written or was given up, a line each time that it begins."""
        self.let_go = 0
        """How many bodies were given up, the oldest."""
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
        """Write these too, whole or not at all; they are the system's when this returns."""
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
        """The results are written: it is not needed any more."""
        self.close()
        remove(self._folder)

    def _write(self, new: bytes, bodies: int) -> None:
        full = self._bytes + len(new) > self._most_bytes or self._bodies + bodies > MOST_BODIES
        if self._file is not None and full:
            self._turn()
        if self._file is None:
            self._file = os.open(self._folder / NAME, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o644)
            self._bytes = self._bodies = 0
        if self._bytes == 0:
            new = self._head + new
        self._append(new)
        self._bodies += bodies
        if time.monotonic() > self._sync_s:
            os.fsync(self._file)
            self._sync_s = time.monotonic() + SYNC_S

    def _turn(self) -> None:
        """Begin a new part; the oldest are given up where they are too many, or where the results,
        written of all of them, would not find room."""
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


def has_journal(folder: Path) -> bool:
    """Whether a folder is that of a run that was cut short, or goes on."""
    return (folder / NAME).is_file()


def parts_of(folder: Path) -> list[Path]:
    """The files of a folder's journal, oldest first."""
    newest = folder / NAME
    before = sorted(folder.glob(BEFORE.replace("{:06d}", "[0-9]" * 6)))
    return [*before, *([newest] if newest.is_file() else [])]


def remove(folder: Path) -> None:
    """Take a folder's journal away, if there is one."""
    for path in parts_of(folder):
        path.unlink(missing_ok=True)


def framed(mark: bytes, payload: bytes) -> bytes:
    """A record: what goes before it, then what it holds."""
    return FRAME.pack(MAGIC, mark, len(payload), zlib.crc32(payload)) + payload
