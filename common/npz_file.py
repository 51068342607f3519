"""Arrays in npz files: no pickle, written completely or not at all, read with a size limit."""

import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from common.atomic_file import replacing

Arrays = dict[str, NDArray[Any]]
"""The arrays of an npz file, by name."""
Facts = dict[str, Any]
"""A JSON object: a summary, a report or an answer, by name."""

DAMAGE: Final = (
    *(ValueError, KeyError, EOFError, RecursionError, MemoryError, NotImplementedError),
    *(tokenize.TokenError, zipfile.BadZipFile, zlib.error, RuntimeError),
)
"""Exceptions of reading a damaged or foreign archive or array."""


class DamagedFile(ValueError):
    """A file without readable arrays: the text says why, and does not name the file."""


def read_arrays(path: Path, most_bytes: int) -> Arrays:
    """All arrays of a file.

    Args:
        path: The npz file.
        most_bytes: Largest size after unpacking; a larger file is refused before it is unpacked.

    Raises:
        OSError: When the file cannot be read.
        DamagedFile: When it is no npz file, is damaged, too large or would need pickle.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            unpacked = sum(member.file_size for member in archive.infolist())
        if unpacked > most_bytes:
            raise DamagedFile(f"{unpacked} bytes unpacked, at most {most_bytes} are taken")
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except DAMAGE as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise DamagedFile(reason) from error


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays, and create the folder where it is missing; the same arrays give the same bytes.

    Raises:
        OSError: When the file cannot be written; the old file is unchanged then.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as new, new.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)
