"""What tracking made of clips, kept on disk: no clip is tracked twice in the same way."""

import hashlib
import io
import json
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np

from common.atomic_file import replacing
from common.cache_folder import DIGEST, add
from common.config import LANDMARK_SOURCES, Settings
from common.npz_file import Arrays, read_arrays
from common.packages import PACKAGES, ROOT
from common.video.clip_sources import ClipError, companions_folder, footage_of
from common.video.clips import find_calibration
from tritrack.offline.lockstep import Tracked
from tritrack.store.past_run import MAX_BYTES
from tritrack.store.runs import poses

KEPT: Final = ("frame", "angles_deg", "joints_m", "joints_px", "confidence", "status")
"""Arrays of `poses.npz` that recognisers and pictures are made of."""

LIBRARIES: Final = ("opencv-python-headless", "scipy")
"""What changes what is tracked and names no compiled code."""


class CachedRun(NamedTuple):
    """As much of a run as recognition needs."""

    facts: dict[str, Any]
    """clip, performer, posture_meant, warnings, as in `summary.json`."""
    arrays: Arrays
    """KEPT, as in `poses.npz`."""


def tracker_id() -> str:
    """A word for the tracker itself: another after any change of our code, models or libraries."""
    digest = hashlib.sha256(DIGEST.encode())
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.npz")):
            add(digest, path.relative_to(ROOT).as_posix(), path.read_bytes())
    for name in LIBRARIES:
        add(digest, name, version(name).encode())
    return digest.hexdigest()


def key_of(settings: Settings, tracker: str) -> str:
    """A word for a clip tracked in one way: another if any file of it or any setting differs.

    Raises:
        ClipError: When a file is missing, or the settings name a camera.
    """
    plain = msgspec.structs.replace(settings, clip="", calibration="")
    digest = hashlib.sha256(tracker.encode())
    add(digest, "settings", msgspec.json.encode(plain))
    add(digest, "clip", Path(settings.clip).resolve().name.encode())
    for path in _files(settings):
        try:
            add(digest, path.name, path.read_bytes())
        except OSError as error:
            raise ClipError(f"cannot read {path}: {error.strerror}; check the path") from error
    return digest.hexdigest()[:32]


def packed(tracked: Tracked) -> bytes:
    """What is kept of a tracked clip, as an npz without pickle."""
    arrays = poses(tracked.bodies)
    facts = json.dumps(tracked.facts).encode()
    file = io.BytesIO()
    np.savez_compressed(
        file,
        allow_pickle=False,
        facts=np.frombuffer(facts, np.uint8),
        **{name: arrays[name] for name in KEPT},
    )
    return file.getvalue()


def write(folder: Path, key: str, content: bytes) -> None:
    """Keep what `packed` gave; a file is there whole or not at all.

    Raises:
        OSError: When it cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / f"{key}.npz") as new:
        new.write_bytes(content)


def read(folder: Path, key: str) -> CachedRun | None:
    """What was kept under a key; None where nothing was, or something that is damaged."""
    try:
        held = read_arrays(folder / f"{key}.npz", MAX_BYTES)
        facts = json.loads(held["facts"].tobytes())
        return CachedRun(facts, {name: held[name] for name in KEPT})
    except (OSError, ValueError, KeyError):
        return None


def _files(settings: Settings) -> Iterator[Path]:
    """All that is read of a clip, in a fixed order."""
    named = footage_of(settings)
    for view in named:
        if isinstance(view.source, int):
            raise ClipError(f"camera {view.source} is no recorded clip: name a clip folder")
        yield Path(view.source)
        if view.settings.background:
            yield Path(view.settings.background)
    folder = companions_folder(settings, named)
    calibration = find_calibration(settings, folder)
    notes = folder / "meta.json"
    if settings.landmarks not in LANDMARK_SOURCES:
        yield from sorted(Path(settings.landmarks).rglob("*.json"))
    yield from (path for path in (calibration, notes) if path is not None and path.is_file())
