"""A run's journal, read: during the run, at its end, or after it was cut short."""

import mmap
import shutil
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final, Generic, NamedTuple, TypeVar

import msgspec

from common.bus.control_messages import Cameras
from common.bus.false_messages import MalformedMessage
from common.bus.message_codec import MAX_BYTES
from common.bus.messages import Body, Message, Posture
from common.config.part_settings import SettingsError
from runtime.store.journal import FRAME, HEAD, KINDS, MAGIC, Head, has_journal, parts_of
from runtime.store.older_messages import read_head, read_message

Kind = TypeVar("Kind", bound=Message)

LOG: Final = "log.txt"
"""Name of the file with the processes' log, beside the journal."""
_MARKS: Final = {kind: mark for mark, kind in KINDS.items()}


class Told(NamedTuple):
    """The content of a journal, each kind in order."""

    head: Head
    bodies: Iterable[Body]
    postures: Iterable[Posture]
    cameras: list[Cameras]


class Journalled(Generic[Kind]):
    """The messages of one kind in a folder's journal: read from disk at each iteration, so that
    they take no memory.

    A torn record, and what follows it in its part, is left out.

    Raises:
        MalformedMessage: During iteration, where another version wrote it.
    """

    def __init__(self, folder: Path, kind: type[Kind]) -> None:
        """Of a folder with or without a journal."""
        self._folder, self._kind = folder, kind

    def __iter__(self) -> Iterator[Kind]:
        """In order."""
        for mark, payload in _records(self._folder):
            if mark == _MARKS[self._kind]:
                yield read_message(payload, self._kind)


def read_journal(folder: Path) -> Told | None:
    """The content of a run folder's journal; None where there is none, or no body in it, or it
    is of another version."""
    bodies, postures = Journalled(folder, Body), Journalled(folder, Posture)
    try:
        heads = (payload for mark, payload in _records(folder) if mark == HEAD)
        head = next(heads, None)
        if head is None or next(iter(bodies), None) is None:
            return None
        next(iter(postures), None)
        cameras = [*Journalled(folder, Cameras)]
        return Told(read_head(msgspec.msgpack.decode(head), Head), bodies, postures, cameras)
    except (msgspec.DecodeError, MalformedMessage, SettingsError):
        return None


def put_aside(folder: Path, aside: Path) -> bool:
    """Move a folder's journal, if it holds a body, into a new folder of its own, with a copy of the
    log, which shows why the run died. The log itself may be open already, and stays.

    Raises:
        OSError: When it cannot be moved.
    """
    if not has_journal(folder) or read_journal(folder) is None:
        return False
    aside.mkdir(parents=True, exist_ok=True)
    for path in parts_of(folder):
        path.replace(aside / path.name)
    log = folder / LOG
    if log.is_file():
        shutil.copy(log, aside)
        log.write_text("")
    return True


def _records(folder: Path) -> Iterator[tuple[bytes, bytes]]:
    """Kind and payload of each record, of each part up to the first incomplete one."""
    for path in parts_of(folder):
        with path.open("rb") as file:
            if path.stat().st_size:  # an empty file cannot be mapped
                with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                    yield from _records_of(data)


def _records_of(data: mmap.mmap) -> Iterator[tuple[bytes, bytes]]:
    at = 0
    while at + FRAME.size <= len(data):
        magic, mark, length, total = FRAME.unpack_from(data, at)
        payload = data[at + FRAME.size : at + FRAME.size + length]
        known = magic == MAGIC and (mark == HEAD or mark in KINDS) and length <= MAX_BYTES
        if not known or len(payload) < length or zlib.crc32(payload) != total:
            return
        yield mark, payload
        at += FRAME.size + length
