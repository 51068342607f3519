"""One process at a time in a folder: which one works there, by a file with its number."""

import os
from pathlib import Path
from typing import Final

import psutil

OWNER: Final = "owner"
"""Name of the file in a folder that a program made for itself."""


def take(file: Path) -> None:
    """Name this process in a file.

    Raises:
        OSError: When it cannot be written.
    """
    file.write_text(str(os.getpid()))


def other_owner(file: Path) -> int | None:
    """The process other than this one that is named in a file and still runs; None: there is none.

    A process that began after the file was written has the number of one that is over.
    """
    try:
        number, taken_s = int(file.read_text()), file.stat().st_mtime
        other = psutil.Process(number)
        is_there = number != os.getpid() and other.create_time() <= taken_s
        killed = is_there and other.status() == psutil.STATUS_ZOMBIE  # and not waited for
    except (OSError, ValueError, psutil.Error):
        return None
    return number if is_there and not killed else None
