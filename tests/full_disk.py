"""A disk that takes no more than it has room for, made of a folder; shared by tests."""

import errno
import io
import os
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import pytest


class FullDisk:
    """What is written below a folder, opened by `Path.open`, ends where its room does.

    As a real one does it takes the first part of what does not fit.
    """

    def __init__(self, folder: Path, room_bytes: float, patch: pytest.MonkeyPatch) -> None:
        self.folder, self.room_bytes = folder, room_bytes
        patch.setattr(Path, "open", self._opening(Path.open))

    @property
    def used_bytes(self) -> int:
        return sum(path.stat().st_size for path in self.folder.rglob("*") if path.is_file())

    def _opening(self, plain: Callable[..., IO[Any]]) -> Callable[..., IO[Any]]:
        def opened(path: Path, mode: str = "r", buffering: int = -1, **more: Any) -> IO[Any]:
            if self.folder not in path.parents or not set(mode) & set("wax+"):
                return plain(path, mode, buffering, **more)
            size = buffering if buffering > 0 else io.DEFAULT_BUFFER_SIZE
            kind = io.BufferedRandom if "+" in mode else io.BufferedWriter
            file = kind(_File(path, mode.replace("b", ""), self), size)
            return file if "b" in mode else io.TextIOWrapper(file)

        return opened


class _File(io.FileIO):
    def __init__(self, path: Path, mode: str, disk: FullDisk) -> None:
        super().__init__(path, mode)
        self._disk = disk

    def write(self, data: Any) -> int:
        room = self._disk.room_bytes - self._disk.used_bytes
        if room <= 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        part = memoryview(data)
        return super().write(part[: int(min(room, len(part)))])
