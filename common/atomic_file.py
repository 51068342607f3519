"""Atomic file writing: a new file replaces the old one completely, or not at all."""

import errno
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

FULL: Final = (errno.ENOSPC, errno.EDQUOT)
"""The errno values that mean that no space is left on the disk or in the quota."""
NAME_BYTES: Final = 8
"""Number of random bytes in the name of a file that is still being written."""


class FileRefused(ValueError):
    """A file that must not be replaced; the text names it and the cure."""


def refuse_to_replace(path: Path, replace: bool, option: str = "--out") -> None:
    """Refuse to replace a file that exists, unless the caller allows it.

    Args:
        path: The file to be written.
        replace: True where the existing file may be replaced.
        option: The command-line option that allows it, for the message.

    Raises:
        FileRefused: When the file exists and may not be replaced.
    """
    if path.exists() and not replace:
        raise FileRefused(f"{path} is there already: name another {option}, or add --force")


def refuse_special(path: Path) -> None:
    """Refuse a path that is a device, a pipe or a socket: replacing it would destroy it.

    Raises:
        FileRefused: When it is one.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise FileRefused(f"{path} is no ordinary file: name another --out")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary file beside `path` to write into; it replaces `path` once it is complete.

    When anything fails, a full disk included, the old file is untouched. The umask decides who may
    read the new file.

    Raises:
        OSError: When the folder cannot be written.
        FileRefused: When `path` is no ordinary file.
    """
    refuse_special(path)
    new = path.with_name(f".{path.stem}.{secrets.token_hex(NAME_BYTES)}{path.suffix}")
    new.open("xb").close()
    try:
        yield new
        new.replace(path)
    except BaseException:
        new.unlink(missing_ok=True)
        raise


def unwritten(path: Path, error: OSError, cure: str) -> str:
    """The message for a file or folder that could not be written.

    Args:
        path: The file or folder.
        error: What the system reported.
        cure: What helps where the disk is not full.
    """
    room = "free some space or " if error.errno in FULL else ""
    return f"cannot write {path}: {error.strerror or error}; {room}{cure}"
