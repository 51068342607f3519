"""What a run over a long film leaves on disk while it goes on, so that it can go on after a stop.

Bodies are the records of the journal, so a run that was cut short is read like one that ended.
ThreadWorker them lie its other messages and, now and then anew, the state of its stages.
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
"""So often the state is written: no more than this is done twice."""
FOLDER: Final = "unfinished"
STATE: Final = "state.bin"
BODIES: Final = "bodies"
SUM_BYTES: Final = 4

State = TypeVar("State")


class CannotResume(RunError):
    """A run that cannot go on: the text says why, and how to begin anew."""


class Saved(msgspec.Struct, frozen=True):
    """How far a run had come."""

    identity: Identity
    stage: str
    """Which of its passes it was in."""
    places: dict[str, Place]
    """How far each of its files of messages had come."""
    state: bytes
    """Of the stages, as `state_codec` has it."""


class UnfinishedRun:
    """The files of a run that goes on."""

    def __init__(
        self,
        folder: Path,
        identity: Identity,
        head: journal.Head,
        saved: Saved | None = None,
    ) -> None:
        """Begin one in a run folder, or go on with what was saved there.

        Args:
            folder: Of the run.
            identity: Of what it is.
            head: Of its journal.
            saved: From `saved_in`; None: what is left there of an older run goes.

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
        """Whether the state is to be saved now."""
        return time.monotonic() >= self._due_s

    def messages(self, name: str) -> MessageFile[Any]:
        """A file of messages, as far as it had come; those of BODIES are the journal's.

        Raises:
            CannotResume: When it was damaged.
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
        """The state in which a stage was left; None where it was not begun, or is over.

        Raises:
            CannotResume: When it was damaged.
        """
        if self._saved is None or self._saved.stage != stage:
            return None
        try:
            return unpacked(self._saved.state, kind)
        except UnreadableState as error:
            raise CannotResume(f"{self._folder / FOLDER / STATE}: {error}: {CURE}") from error

    def save(self, stage: str, state: object) -> None:
        """Write how far all has come, whole or not at all.

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
        """The run begins anew: no state is left to go on from, and what is still to be written of
        the journal is written before a new one takes its place."""
        self._saved = None
        with writing(self._folder):
            (self._folder / FOLDER / STATE).unlink(missing_ok=True)
        journal_before = self._files.pop(BODIES, None)
        if journal_before is not None:
            journal_before.close()

    def close(self) -> None:
        """Write no more; what is done stays."""
        for file in self._files.values():
            file.close()

    def remove(self) -> None:
        """Nothing of this is needed any more; a run folder without results goes too."""
        self.close()
        discard(self._folder)
        with contextlib.suppress(OSError):
            self._folder.rmdir()


CURE: Final = "leave out --resume to begin anew"


def saved_in(folder: Path, identity: Identity) -> Saved | None:
    """How far the run in a folder had come; None where none was cut short, or it saved nothing yet.

    Raises:
        CannotResume: When that is of another run, or was damaged.
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
    """Refuse to go on with a run that was begun of something else.

    Raises:
        CannotResume: With what differs.
    """
    changed = differing(before, now)
    if changed:
        raise CannotResume(
            f"{folder} holds a run that cannot go on: since it was begun {', '.join(changed)} "
            f"changed; undo that, or {CURE}"
        )


def discard(folder: Path) -> None:
    """Take away what a run left that was cut short.

    Raises:
        OSError: When it cannot be taken away.
    """
    journal.remove(folder)
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(folder / FOLDER)
