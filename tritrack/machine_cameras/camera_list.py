"""The cameras of this machine, by what the platform tells, and files that play as cameras."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

from common.video.pictures import Source

V4L: Final = Path("/sys/class/video4linux")
"""Where Linux lists its cameras."""
TRIED: Final = 4
"""Devices that are tried where the platform has no list: they can only be opened to be found."""
_NONE: Final = (
    "This machine has no camera that the system knows. Plug one in, then look again; where it is "
    "plugged in, see that you may use it (group video) and that tritrack doctor names it. A "
    "recorded video plays as a camera: {command} --camera VIDEO"
)


def no_camera(command: str) -> str:
    """What to do where there is none.

    Args:
        command: The present one, which takes videos instead.
    """
    return _NONE.format(command=command)


class FoundCamera(NamedTuple):
    """A camera, not opened."""

    camera: str
    """Its id on the page."""
    name: str
    where: str
    """Bus path, or the file's path: what tells two of one name apart."""
    source: Source


def cameras_of(files: Sequence[Path], listed: Path = V4L) -> list[FoundCamera]:
    """The cameras, then the files, in order.

    Args:
        files: They play as cameras.
        listed: Linux's list, which is missing where there is no camera; where its folder is
            missing too, this is another system, and the first devices are named, to be tried.
    """
    found = [] if listed.parent.is_dir() else devices_to_try()
    found = linux_cameras(listed) if listed.is_dir() else found
    return found + [
        FoundCamera(f"file{n}", path.name, f"a video that plays as a camera: {path}", str(path))
        for n, path in enumerate(files)
    ]


def linux_cameras(listed: Path) -> list[FoundCamera]:
    """The devices that give pictures; a camera's further devices, as of metadata, do not."""
    found = []
    for path in sorted(listed.iterdir(), key=lambda each: (len(each.name), each.name)):
        number = re.fullmatch(r"video(\d+)", path.name)
        if number is None or _read(path / "index") not in ("", "0"):
            continue
        device = path / "device"
        where = device.resolve().name if device.exists() else path.name
        name = _read(path / "name") or path.name
        found.append(FoundCamera(path.name, name, f"{where} (/dev/{path.name})", int(number[1])))
    return found


def devices_to_try() -> list[FoundCamera]:
    """The first devices of a platform without a list."""
    return [FoundCamera(f"video{n}", f"camera {n}", f"device {n}", n) for n in range(TRIED)]


def _read(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:
        return ""
