"""Identity of a run: digests of its settings, its input files, and the program itself."""

import hashlib
import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Final

import msgspec

from common.config.settings import LANDMARK_SOURCES, NETWORK, Settings
from common.packages import PACKAGES, ROOT
from common.source_digest import add, digest_of
from common.video.clip_sources import ClipError, companions_folder, sources_of
from common.video.clips import find_calibration
from common.video.pictures import is_recorded

Identity = dict[str, str]
"""A digest of everything that a run depends on, by its name in messages."""

MODELS: Final = ("*.npz", "*.onnx")
LIBRARIES: Final = ("numpy", "numba", "opencv-python-headless", "scipy", "onnxruntime")
"""Settings that change the tracking."""
SOURCES: Final = digest_of(ROOT)
"""Digest of the sources when this process began: taken at import, before any edit."""


def identity_of(settings: Settings, told: Mapping[str, object]) -> Identity:
    """Dependencies of a run over a recorded clip; the place of its files does not count.

    Args:
        settings: The resolved settings of the run.
        told: Further facts from its command, by name.

    Raises:
        ClipError: When the clip has no files, or the settings name a camera.
    """
    plain = msgspec.structs.replace(settings, clip="", calibration="")
    found = {"the program": tracker_id(), "the settings": _digest(plain)}
    found |= {name: _digest(value) for name, value in told.items()}
    for path in files_of(settings):
        try:
            with path.open("rb") as file:
                found[path.name] = hashlib.file_digest(file, "sha256").hexdigest()
        except OSError:
            found[path.name] = ""  # opening the clip gives a better message
    return found


def differing(before: Identity, now: Identity) -> list[str]:
    """Names of the changed items."""
    names = [*before, *(name for name in now if name not in before)]
    return [name for name in names if before.get(name) != now.get(name)]


def word_of(identity: Identity) -> str:
    """One digest of everything."""
    return _digest(identity)[:32]


def tracker_id() -> str:
    """A digest of the tracker itself: it changes with our code, models and libraries."""
    digest = hashlib.sha256(SOURCES.encode())
    for package in PACKAGES:
        models = (path for kind in MODELS for path in (ROOT / package).rglob(kind))
        for path in sorted(models):
            add(digest, path.relative_to(ROOT).as_posix(), path.read_bytes())
    add(digest, "python", sys.version.encode())
    for name in LIBRARIES:
        add(digest, name, version(name).encode())
    return digest.hexdigest()


def files_of(settings: Settings) -> Iterator[Path]:
    """All files read of a clip, in a fixed order."""
    named = sources_of(settings)
    for view in named:
        if not is_recorded(view.source):
            raise ClipError(f"camera {view.source} is no recorded clip: name a clip folder")
        yield Path(view.source)
        if view.settings.background:
            yield Path(view.settings.background)
    folder = companions_folder(settings, named)
    calibration = find_calibration(settings, folder)
    notes = folder / "meta.json"
    if settings.landmarks.endswith(NETWORK):
        yield Path(settings.landmarks)
    elif settings.landmarks not in LANDMARK_SOURCES:
        yield from sorted(Path(settings.landmarks).rglob("*.json"))
    yield from (path for path in (calibration, notes) if path is not None and path.is_file())


def _digest(value: object) -> str:
    return hashlib.sha256(msgspec.json.encode(value)).hexdigest()
