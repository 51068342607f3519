"""Dropped files: received piece by piece into a temporary folder, bounded in size and number."""

import os
import re
import secrets
import shutil
import unicodedata
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Final

from animator.start.wishes import Begin, Chunk
from common.atomic_file import unwritten
from common.bus.messages import MOST_VIEWS
from common.folder_owner import OWNER, other_owner, take
from tritrack.recording_cameras.recorded_clips import recorded_times

FOLDER: Final = ".uploads"
MOST_BYTES: Final = 1 << 33
"""Upper bound of a video, bytes: an hour of one camera is a tenth of it."""
MOST_CALIBRATION_BYTES: Final = 1 << 24
CALIBRATIONS: Final = (".toml", ".yml", ".yaml", ".xml", ".txt")
"""Suffixes of calibration files of other programs."""
SPARE_BYTES: Final = 1 << 30
"""Free space that a file must leave on the disk, bytes."""
MOST_LETTERS: Final = 80
"""Of a file's name."""
MOST_CALLED: Final = 200
"""Of its user's name for it, from the end."""
MOST_NUMBER: Final = 1 << 32
"""Upper bound of a file's number."""


class UploadRefused(ValueError):
    """A file that is not taken; the text says why and what to do."""


@dataclass
class Upload:
    """A file that comes or has come."""

    number: int
    path: Path
    bytes: int
    got: int = 0
    called: str = ""
    """What its user calls it."""
    times_s: tuple[float, ...] = ()
    """When its frames were taken, on the clock of its recording; (): not known."""
    recording: str = ""
    """Files of one recording share a clock."""

    @property
    def title(self) -> str:
        """Its name for its user."""
        return self.called or self.path.name

    @property
    def is_whole(self) -> bool:
        """Whether all of it has come."""
        return self.got == self.bytes

    @property
    def is_calibration(self) -> bool:
        """Whether it is a calibration of another program, by its name."""
        return self.path.suffix.lower() in CALIBRATIONS


def last_part(name: str) -> str:
    """A file's name without folders, of any system."""
    return re.split(r"[\\/]", name)[-1]


def safe_name(name: str) -> str:
    """A file's name without folders, hidden names and signs that a shell or a system minds."""
    letters = unicodedata.normalize("NFKD", last_part(name).replace("ß", "ss"))
    bare = "".join(each for each in letters if not unicodedata.combining(each))
    plain = re.sub(r"[^A-Za-z0-9._-]+", "_", bare).lstrip("._-")
    stem, dot, suffix = plain.rpartition(".")
    suffix = suffix[:10]
    kept = f"{stem[: MOST_LETTERS - len(suffix) - 1]}.{suffix}" if dot and stem else plain
    return kept[:MOST_LETTERS] or "video"


def link_or_copy(source: Path, target: Path) -> None:
    """Put a file at another path: as a link, else a copy.

    Raises:
        OSError: When neither can be made.
    """
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def refuse_other_page(folder: Path) -> None:
    """Refuse a folder that another start page works in: each cleans what it does not know.

    Raises:
        UploadRefused: When one does.
    """
    number = other_owner(folder / OWNER)
    if number is not None:
        raise UploadRefused(
            f"another start page (process {number}) works in {folder.parent}: use that one, or "
            "name another --runs"
        )


class Uploads:
    """The files of the tray, in the order of the cameras.

    Args:
        folder: Made anew; all in it is removed.
        most_bytes: Upper bound of a file.
    """

    def __init__(self, folder: Path, most_bytes: int = MOST_BYTES) -> None:
        self.files: list[Upload] = []
        self._folder, self._most_bytes = folder, most_bytes
        self._open: dict[int, IO[bytes]] = {}
        refuse_other_page(folder)
        shutil.rmtree(folder, ignore_errors=True)
        try:
            folder.mkdir(parents=True)
            take(folder / OWNER)
        except OSError as error:
            raise UploadRefused(unwritten(folder, error, "name another --runs")) from error

    def begin(self, wish: Begin) -> Upload:
        """Begin to receive a file.

        Raises:
            UploadRefused: When it is too large, empty, one too many, or there is no space.
        """
        name = safe_name(wish.name)
        called = last_part(wish.name)[-MOST_CALLED:]
        found = Upload(wish.file, self._folder / str(wish.file) / name, wish.bytes, called=called)
        most = MOST_CALIBRATION_BYTES if found.is_calibration else self._most_bytes
        if not 0 <= wish.file < MOST_NUMBER or any(one.number == wish.file for one in self.files):
            raise UploadRefused(f"{name}: a file with this number is there already")
        self._refuse_one_more(name)
        if wish.bytes <= 0:
            raise UploadRefused(f"{name} is empty: copy or record it again")
        if wish.bytes > most:
            raise UploadRefused(
                f"{name} has {wish.bytes / 1e9:.1f} GB, the page takes {most / 1e9:.1f} at most: "
                "name it in the command instead"
            )
        due = sum(one.bytes - one.got for one in self.files)  # of those that still come
        if wish.bytes + due + SPARE_BYTES > shutil.disk_usage(self._folder).free:
            raise UploadRefused(f"{name}: there is no space for it on the disk: free some")
        found.path.parent.mkdir()
        self._open[wish.file] = found.path.open("xb")
        self.files.append(found)
        return found

    def put_back(self, path: Path, name: str) -> Upload:
        """Take a file that lies on this disk already, by its former name, with the times of its
        frames where they are known.

        Raises:
            UploadRefused: When it is one too many, or cannot be linked.
        """
        self._refuse_one_more(name)
        number = secrets.randbelow(MOST_NUMBER)
        try:
            found = Upload(number, self._folder / str(number) / name, path.stat().st_size)
            found.path.parent.mkdir()
            link_or_copy(path, found.path)
        except OSError as error:
            raise UploadRefused(unwritten(path, error, "drop the file again")) from error
        found.got = found.bytes
        found.times_s = recorded_times(path)
        found.recording = str(path.parent) if found.times_s else ""
        self.files.append(found)
        return found

    def refuse_more(self, number: int) -> None:
        """Refuse files of which some would find no room.

        Raises:
            UploadRefused: When there are too many.
        """
        if len(self.files) + number > MOST_VIEWS:
            raise UploadRefused(
                f"{len(self.files)} files are there already, and {MOST_VIEWS} is the most: take "
                "some away"
            )

    def _refuse_one_more(self, name: str) -> None:
        if len(self.files) >= MOST_VIEWS:
            raise UploadRefused(f"{name}: {MOST_VIEWS} files are there already: take one away")

    def take(self, chunk: Chunk) -> Upload | None:
        """The file after one more piece of it; a piece that was there already changes nothing.

        Raises:
            UploadRefused: When it cannot be written.
        """
        found = next((one for one in self.files if one.number == chunk.file), None)
        if found is None or chunk.file not in self._open or chunk.start != found.got:
            return found
        fits = chunk.content[: found.bytes - found.got]
        try:
            self._open[chunk.file].write(fits)
            found.got += len(fits)
            if found.is_whole:
                self._open.pop(chunk.file).close()
        except OSError as error:
            self.drop(chunk.file)
            raise UploadRefused(unwritten(found.path, error, "take the file away")) from error
        return found

    def earlier(self, number: int) -> None:
        """Move a file one place to the front."""
        at = next((n for n, one in enumerate(self.files) if one.number == number), 0)
        if at:
            self.files[at - 1 : at + 1] = reversed(self.files[at - 1 : at + 1])

    def drop(self, number: int | None) -> None:
        """Remove a file; None: all."""
        for one in [one for one in self.files if number in (None, one.number)]:
            file = self._open.pop(one.number, None)
            if file is not None:
                with suppress(OSError):  # a full disk takes what is still to be written no better
                    file.close()
            shutil.rmtree(one.path.parent, ignore_errors=True)
            self.files.remove(one)

    def close(self) -> None:
        """Remove all of it."""
        self.drop(None)
        shutil.rmtree(self._folder, ignore_errors=True)
