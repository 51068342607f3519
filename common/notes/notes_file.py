"""Notes on disk: a small text file beside the video that people can read and edit."""

import re
import tomllib
from pathlib import Path
from typing import Final

import msgspec

from common.atomic_file import replacing
from common.body.body import JOINT_NAMES, LIMBS
from common.config.explained import explained
from common.config.toml_fault import toml_fault
from common.notes.notes import ORIENTATIONS, Notes

MAX_BYTES: Final = 1 << 20
"""Upper bound of a notes file's size, bytes."""

CURES: Final = {
    "frame": "give the number of a frame, counted from 0",
    "orientation": f"write one of {', '.join(ORIENTATIONS)}, or auto",
    "depth": f"write SEGMENT = 'toward', 'away' or 'auto'; segments are {', '.join(LIMBS)}",
    "joints_px": f"write JOINT = [column, row] or 'auto'; joints are {', '.join(JOINT_NAMES)}",
    "video": "write the name of the video file in quotes",
    "note": "begin each with [[note]], then frame = NUMBER",
}
"""Cures, by key."""

HEAD: Final = f"""\
# What the pictures of a video do not show: read by `tritrack single`, edited by `tritrack retouch`
# (which keeps what you write beside). A note holds from its frame on, until another changes it.
#   orientation  {", ".join(ORIENTATIONS)}
#   depth        of a segment's far end: toward or away from the camera
#   joints_px    column and row of a joint that is hidden
# "auto" gives a decision back to the program.

"""


class NotesError(ValueError):
    """Notes that cannot be read or written: the text names the file, the line and the cure."""


def notes_path(video: Path) -> Path:
    """The path of a video's notes, whether the file exists or not: `notes.toml` beside the video.

    Where that file names another video of the same folder, it is NAME.notes.toml.

    Raises:
        NotesError: When there is a `notes.toml` that cannot be read.
    """
    shared, own = video.with_name("notes.toml"), video.with_name(f"{video.stem}.notes.toml")
    if own.exists() or (shared.exists() and load_notes(shared).video not in ("", video.name)):
        return own
    return shared


def load_notes(path: Path) -> Notes:
    """Read notes.

    Raises:
        NotesError: When they cannot be read or are invalid.
    """
    try:
        size = path.stat().st_size
        text = path.read_text("utf-8") if size <= MAX_BYTES else ""
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise NotesError(f"cannot read the notes {path}: {reason}; name another file") from error
    if size > MAX_BYTES:
        raise NotesError(f"{path} has {size} bytes, notes have at most {MAX_BYTES}: shorten it")
    try:
        return msgspec.convert(tomllib.loads(text), Notes)
    except tomllib.TOMLDecodeError as error:
        raise NotesError(f"{path}: {toml_fault(str(error))}; mend that line") from error
    except (msgspec.ValidationError, RecursionError) as error:
        raise NotesError(f"{path}{_mended(error, text)}") from error


def save_notes(path: Path, notes: Notes) -> None:
    """Write notes completely or not at all; comments in the file stay.

    Raises:
        NotesError: When they cannot be written: no space, no permission, or another program damaged
            the file. The file is unchanged then.
    """
    from tomlkit.exceptions import TOMLKitError

    from common.notes.notes_text import notes_text

    try:
        before = path.read_text("utf-8") if path.exists() else HEAD
        text = notes_text(notes, before)
        with replacing(path) as new:
            new.write_text(text, "utf-8")
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise NotesError(f"{path} was changed and is no TOML: {error}; mend that line") from error
    except OSError as error:
        raise NotesError(
            f"cannot write {path}: {error.strerror}; the old notes are untouched: free some "
            "space, or see that you may write there"
        ) from error


def _mended(error: Exception, text: str) -> str:
    """The fault, its line, and what to write instead."""
    reason, _, place = str(error).partition(" - at ")
    number = re.search(r"note\[(\d+)\]", place)
    words = re.findall(r"[a-z_]+", place.rpartition("note[")[2] or place) + reason.split()
    known = (*CURES, *re.findall(r"unknown field `([^`]*)`", reason))
    key = next((word for word in reversed(known) if word in words or f"`{word}`" in words), "note")
    line = _line_of(text, int(number[1]) if number else None, key)
    cure = CURES.get(key, f"known are {', '.join(CURES)}")
    return f"{f', line {line}' if line else ''}, {key}: {explained(error, Notes)}; {cure}"


def _line_of(text: str, number: int | None, key: str) -> int | None:
    """The line of a key in a note; the note's first line where the key is not found."""
    heads, found = 0, None
    for at, line in enumerate(text.splitlines(), 1):
        if re.match(r"\s*\[\[\s*note\s*\]\]", line):
            heads += 1
            found = at if heads - 1 == number else found
        if heads - 1 == number and re.match(rf"\s*(\[\s*note\.)?{re.escape(key)}\b", line):
            return at
    return found
