"""Files that take the place of older ones whole, or not at all."""

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

FULL: Final = (errno.ENOSPC, errno.EDQUOT)
"""Of an error where space is what lacks."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A file beside `path` to write into; it takes its place when all of it was written.

    When anything fails, a full disk too, what stood there before is untouched.

    Raises:
        OSError: When the folder cannot be written.
    """
    handle, name = tempfile.mkstemp(path.suffix, f".{path.stem}.", path.parent)
    os.close(handle)
    new = Path(name)
    try:
        yield new
        new.chmod(0o644)
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
