"""Intermediate results of a run over a long video, on disk, for resuming.

Bodies are the records of the journal, so a run that was cut short is read like a complete one.
Beside them are its other messages and, rewritten from time to time, the state of its stages.
"""

import contextlib
import os
import shutil
import time
import zlib
from pathlib import Path
from typing import Any, Final, TypeVar

import msgspec

from common.atomic_file import replacing
from runtime.store import journal
from runtime.store.runs import RunError
from runtime.unfinished.message_file import MessageFile, Place, Torn, writing
from runtime.unfinished.run_identity import Identity, differing
from runtime.unfinished.state_codec import UnreadableState, packed, unpacked

SAVES_S: Final = 10.0
"""Seconds between two saved states: at most that much work is repeated."""
FOLDER: Final = "unfinished"
STATE: Final = "state.bin"
BODIES: Final = "bodies"
SUM_BYTES: Final = 4

State = TypeVar("State")


class CannotResume(RunError):
    """A run that cannot resume: the text names the cause, and how to begin again."""


class Saved(msgspec.Struct, frozen=True):
    """Progress of a run."""

    identity: Identity
    stage: str
    """The present pass."""
    places: dict[str, Place]
    """Extent of each of its message files."""
    state: bytes
    """States of the stages, from `state_codec`."""


class UnfinishedRun:
    """The files of a run in progress."""

    def __init__(
        self,
        folder: Path,
        identity: Identity,
        head: journal.Head,
        saved: Saved | None = None,
    ) -> None:
        """Begin them in a run folder, or continue from the saved ones.

        Args:
            folder: The run's folder.
            identity: The run's identity.
            head: Header of its journal.
            saved: From `saved_in`; None: remains of an older run are removed.

        Raises:
            RunError: When the folder cannot be written.
        """
        self._folder, self._identity, self._head = folder, identity, head
        self._saved = saved
        self._files: dict[str, MessageFile[Any]] = {}
        self._due_s = time.monotonic() + SAVES_S
        with writing(folder):
            if saved is None:
                discard(folder)

    @property
    def due(self) -> bool:
        """Whether the state is due to be saved."""
        return time.monotonic() >= self._due_s

    def messages(self, name: str) -> MessageFile[Any]:
        """A message file, up to its saved extent; that of BODIES is the journal.

        Raises:
            CannotResume: When it is damaged.
            RunError: When it cannot be written.
        """
        is_journal = name == BODIES
        path = self._folder / (journal.NAME if is_journal else f"{FOLDER}/{name}.bin")
        head = msgspec.msgpack.encode(self._head) if is_journal else b""
        place = self._saved.places.get(name) if self._saved else None
        with writing(self._folder):
            (self._folder / FOLDER).mkdir(parents=True, exist_ok=True)
        try:
            self._files[name] = MessageFile(path, head, place)
        except Torn as error:
            raise CannotResume(f"{error}: {CURE}") from error
        return self._files[name]

    def resumed(self, stage: str, kind: type[State]) -> State | None:
        """The saved state of a stage; None where it was not begun, or is over.

        Raises:
            CannotResume: When it is damaged.
        """
        if self._saved is None or self._saved.stage != stage:
            return None
        try:
            return unpacked(self._saved.state, kind)
        except UnreadableState as error:
            raise CannotResume(f"{self._folder / FOLDER / STATE}: {error}: {CURE}") from error

    def save(self, stage: str, state: object) -> None:
        """Save the progress, completely or not at all.

        Raises:
            RunError: When it cannot be written.
        """
        places = {name: file.synced() for name, file in self._files.items()}
        saved = Saved(self._identity, stage, places, packed(state))
        content = msgspec.msgpack.encode(saved)
        new_state = replacing(self._folder / FOLDER / STATE)
        with writing(self._folder), new_state as new, new.open("wb") as file:
            file.write(zlib.crc32(content).to_bytes(SUM_BYTES, "little") + content)
            file.flush()
            os.fsync(file.fileno())
        self._due_s = time.monotonic() + SAVES_S

    def restart(self) -> None:
        """The run begins again: the saved state is removed, and pending journal records are
        written before a new journal replaces it."""
        self._saved = None
        with writing(self._folder):
            (self._folder / FOLDER / STATE).unlink(missing_ok=True)
        journal_before = self._files.pop(BODIES, None)
        if journal_before is not None:
            journal_before.close()

    def close(self) -> None:
        """Write no more; the results so far stay."""
        for file in self._files.values():
            file.close()

    def remove(self) -> None:
        """Remove everything; a run folder without results is removed too."""
        self.close()
        discard(self._folder)
        with contextlib.suppress(OSError):
            self._folder.rmdir()


CURE: Final = "leave out --resume to begin anew"


def saved_in(folder: Path, identity: Identity) -> Saved | None:
    """Progress of the run in a folder; None where none was cut short, or nothing was saved yet.

    Raises:
        CannotResume: When it is of another run, or damaged.
    """
    path = folder / FOLDER / STATE
    if not path.is_file():
        return None
    try:
        content = path.read_bytes()
        total, content = content[:SUM_BYTES], content[SUM_BYTES:]
        if zlib.crc32(content).to_bytes(SUM_BYTES, "little") != total:
            raise CannotResume(f"{path} was damaged: {CURE}")
        saved = msgspec.msgpack.decode(content, type=Saved)
    except (OSError, msgspec.DecodeError) as error:
        raise CannotResume(f"{path} cannot be read ({error}): {CURE}") from error
    refuse_another(folder, saved.identity, identity)
    return saved


def refuse_another(folder: Path, before: Identity, now: Identity) -> None:
    """Refuse to resume a run with a changed identity.

    Raises:
        CannotResume: It names the differences.
    """
    changed = differing(before, now)
    if changed:
        raise CannotResume(
            f"{folder} holds a run that cannot go on: since it was begun {', '.join(changed)} "
            f"changed; undo that, or {CURE}"
        )


def discard(folder: Path) -> None:
    """Remove the remains of a run that was cut short.

    Raises:
        OSError: When it cannot be taken away.
    """
    journal.remove(folder)
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(folder / FOLDER)
