"""Files that take the place of older ones whole, or not at all."""

import errno
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

FULL: Final = (errno.ENOSPC, errno.EDQUOT)
"""Of an error where space is what lacks."""
NAME_BYTES: Final = 8
"""Of chance in the name of a file that is not whole yet."""


class FileRefused(ValueError):
    """A file whose place no other may take; the text names it and the cure."""


def refuse_to_replace(path: Path, replace: bool, option: str = "--out") -> None:
    """Say that a file is there already, unless it may be lost.

    Args:
        path: The file.
        replace: It may be lost.
        option: Of the command, which names it.

    Raises:
        FileRefused: When it is there and may not.
    """
    if path.exists() and not replace:
        raise FileRefused(f"{path} is there already: name another {option}, or add --force")


def refuse_special(path: Path) -> None:
    """Say that a device, a pipe or a socket is there, of which a file would make an end.

    Raises:
        FileRefused: When it is.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise FileRefused(f"{path} is no ordinary file: name another --out")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A file beside `path` to write into; it takes its place when all of it was written.

    When anything fails, a full disk too, what stood there before is untouched. Who may read it is
    the user's to say, as of any file: by their umask.

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
    """What to say of a file or folder that could not be written.

    Args:
        path: Of it.
        error: Why.
        cure: What helps, whatever it was.
    """
    room = "free some space or " if error.errno in FULL else ""
    return f"cannot write {path}: {error.strerror or error}; {room}{cure}"
